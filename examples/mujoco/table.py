#!/usr/bin/env python3
"""Writes the table of bounds into the book: `.ci/mujoco --table` says from what.

    python3 examples/mujoco/table.py ROWS.json TESTS.txt docs/src/whole-body-torques.md

ROWS.json is of bounds.py, TESTS.txt what the tests `silence` of examples and moca-model print.
"""

import json
import pathlib
import re
import sys

BEGIN, END = "<!-- bounds: begin; .ci/mujoco --table -->", "<!-- bounds: end -->"
KINDS = {"silent": "measurements missing", "frozen": "measurements frozen", "lost": "commands lost"}
HEARD = {"Nothing": "silent", "Frozen": "frozen"}
FOR_EVER = "1000"  # ms in the tests


def signed(number):
    return f"{number:.2f}".replace("-", "−")


def trouble(row, simulated):
    ticks = FOR_EVER if row["ms"] is None else str(row["ms"])
    what = KINDS[row["kind"]] + (" for ever" if row["ms"] is None else f" for {row['ms']} ms")
    name = f"{row['fault']} ms" if row["fault"] else "none"
    speed, fault = simulated.get((row["kind"], ticks), (None, None))
    simulated_name = "" if fault is None else f"{fault} ms" if fault else "none"
    return [what, "" if speed is None else signed(speed), simulated_name, signed(row["beyond"]), name]


def steady(row, simulated):
    error = simulated.get((row["delay"], row["every"]))
    measured = f"{row['error']:.3f} ({row['rms']:.3f})" if "error" in row else "refused"
    return [f"{1000 // row['every']} Hz, {row['delay']} ms late", "" if error is None else f"{error:.3f}", measured]


def refused(row):
    reason = re.search(r"(measures every|answers) [\d.]+ ms( late)?", row["refusal"])
    return [f"{1000 // row['every']} Hz, {row['delay']} ms late", "", "refused at start" if reason else "**not refused**"]


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines)


def main():
    rows_file, tests_file, page = map(pathlib.Path, sys.argv[1:])
    rows, tests = json.loads(rows_file.read_text()), tests_file.read_text()
    found = re.findall(r"bound (\w+) (\d+) ms: (-?[\d.]+) rad/s, fault (\d+) ms", tests)
    simulated = {(HEARD[heard], ticks): (float(speed), int(fault)) for heard, ticks, speed, fault in found}
    rides = re.findall(r"(\d+) ms, every (\d+) ms: [\d.]+ of the speeds, error ([\d.]+) rad", tests)
    errors = {(int(delay), int(every)): float(error) for delay, every, error in rides}
    if not simulated or not errors:
        sys.exit(f"{tests_file} has no bounds: run the tests `silence` with --nocapture")
    count = rows["trouble"][0]["moments"]
    troubles = [trouble(row, simulated) for row in rows["trouble"]]
    rates = [steady(row, errors) for row in rows["steady"]] + [refused(row) for row in rows["refused"]]
    text = f"""{BEGIN}

The next table has {count} moments of the run of `follow` for MuJoCo, and 50 for `DynamicRobot`. *Beyond* is by how much a joint was faster
than 1.2 times its speed when it began and 0.1 rad/s, in rad/s, at worst: below zero is within. *Fault* is the latest, after the
first value that did not come. In MuJoCo all ten joints count, in `DynamicRobot` those of the arm.

{table(["trouble", "`DynamicRobot`: beyond", "fault", "MuJoCo: beyond", "fault"], troubles)}

The largest following error of a joint at full speed, in MuJoCo with its RMS, in rad; late is beyond the one period
that every loop takes.

{table(["measurements", "`DynamicRobot`", "MuJoCo"], rates)}

{END}"""
    book = page.read_text()
    before, rest = book.split(BEGIN)
    page.write_text(before + text + rest.split(END)[1])


if __name__ == "__main__":
    main()
