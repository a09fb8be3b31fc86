#!/usr/bin/env python3
"""Measures how still the robot is over many recordings, and writes the table of the book's page `moca-model-stillness.md`.

    python3 docs/calmness.py                        # 20 recordings; builds the programs in release
    python3 docs/calmness.py --recordings 2 --print # prints the table of two recordings, and writes no page
    python3 docs/calmness.py --programs FOLDER      # takes the programs that are in FOLDER
    python3 docs/calmness.py --real                 # another table: people who move as real ones
    python3 docs/calmness.py --people               # another table: other statures, paths and movements

Each recording is made by `record` with a seed of its own, and played by `follow`: with separation and without, with
cameras of less noise, and with people who sway and errors that last as those of real ones. The robot does not know of a
camera without noise, and measures itself with ten times the noise there. The table marks means that miss their floor.
The people of --real repeat captured motions before the robot, seen with lasting errors.
"""

import argparse
import datetime
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor

from comparison import ROOT, machine, write_block

PAGE = ROOT / "docs/src/moca-model-stillness.md"
TICK = 1e-3  # control period [s]
# Motions of `record --motion`, what they are, and the number of seeds.
MOTIONS = {"walk": "gait", "balance": "balancing on a beam", "punch": "punches", "dance": "dancing", "get-up": "getting up"}
SEEDS = 5
# People of `record`: what they are, and their options. Each has as many seeds as EACH.
PEOPLE = [
    *((f"{stature:.2f} m tall", ["--stature", f"{stature:.2f}"]) for stature in (1.5 + 0.05 * step for step in range(10))),
    ("path `square`", ["--path", "square"]),
    ("path `figure-eight`", ["--path", "figure-eight"]),
    ("steps of 10 cm to a side", ["--path", "1.4,0 1.4,0.1 1.4,0 1.4,-0.1 1.4,0"]),
    ("movement `step-sideways`", ["--movement", "step-sideways"]),
    ("movement `lean-sideways`", ["--movement", "lean-sideways"]),
    ("movement `bow`", ["--movement", "bow"]),
    ("movement `turn`", ["--movement", "turn"]),
]
EACH = 3

# Heading of a column, factor on the camera's noise, and options of `record` and `follow`.
COLUMNS = [
    ("with separation", 1.0, [], []),
    ("`--no-separation`", 1.0, [], ["--no-separation"]),
    ("half the noise", 0.5, [], []),
    ("a quarter of the noise", 0.25, [], []),
    ("no noise, own noise × 10", 0.0, [], ["--robot-noise", "10"]),
    ("sway and lasting errors", 1.0, ["--sway", "1", "--lasting", "0.9"], []),
]
QUIET = [noise for _, noise, *_ in COLUMNS].index(0.0)


def at_once(what, play, items):
    """The results of `play` for all items, in their order, as many at a time as there are cores."""
    items = list(items)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        started = [pool.submit(play, item) for item in items]
        for done, run in enumerate(started, 1):
            run.result()
            print(f"{what} {done} of {len(items)}", file=sys.stderr, flush=True)
    return [run.result() for run in started]


def settings(programs, noise, folder):
    """A settings file for a camera with this factor on its noise."""
    path, line = folder / f"noise-{noise}.toml", "position_sigma = "
    if path.exists():
        return path
    subprocess.run([programs / "follow", "--write-settings", path], check=True, stdout=subprocess.DEVNULL)
    lines = path.read_text().splitlines()
    (at,) = [index for index, text in enumerate(lines) if text.startswith(line)]
    lines[at] = line + str(noise * float(lines[at].removeprefix(line)))
    path.write_text("\n".join(lines))
    return path


def summary(programs, name, folder, made, options):
    """The summary of `follow` with options for a recording of this name, made by `record` with others."""
    recording, truth = (folder / f"{name}.{kind}" for kind in ("jsonl", "truth"))
    if not truth.exists():
        made = ["--quiet", *made, "--output", recording, "--truth", truth]
        subprocess.run([programs / "record", *made], check=True, stdout=subprocess.DEVNULL)
    command = ["--quiet", "--json", "--no-report", "--recording", recording, "--truth", truth, *options]
    run = subprocess.run([programs / "follow", *command], check=True, text=True, stdout=subprocess.PIPE)
    return json.loads(run.stdout.splitlines()[-1])


def play(programs, seed, folder):
    """The summaries of `follow` for the recording of this seed, one for each column."""
    summaries = []
    for _, noise, real, options in COLUMNS:
        name = f"{seed}-{noise}{'-real' if real else ''}"
        made = ["--seed", str(seed), "--noise", str(noise), *real]
        # A robot that expects no noise at all would be another robot.
        options = [*options, "--settings", settings(programs, noise or 1.0, folder)]
        summaries.append(summary(programs, name, folder, made, options))
    for run in summaries:
        run["quiet"] = summaries[QUIET]
    return summaries


def real(programs, folder):
    """The table of people who repeat the motions of real ones."""
    heads = [
        "motion", "trunk while it moves, root mean square", "workpiece then", "workpiece / trunk (worst)",
        "e_s with ergonomics and without", "retreats a minute", "ticks too near",
    ]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]

    def play(case):
        motion, seed = case
        made = ["--motion", motion, "--duration", "40", "--lasting", "0.9", "--seed", str(seed)]
        return summary(programs, f"{motion}-{seed}", folder, made, [])

    seeds = range(1, SEEDS + 1)
    played = at_once("run", play, [(motion, seed) for motion in MOTIONS for seed in seeds])
    for index, (motion, what) in enumerate(MOTIONS.items()):
        runs = played[index * SEEDS : (index + 1) * SEEDS]
        mean = lambda values: sum(values) / len(values)
        # Of the run with ergonomics, while the trunk is faster than 0.2 m/s.
        moves = [run["calmness"]["walking"] for run in runs if run["calmness"]["walking"]]
        # Retreats and ticks are those of both runs.
        ticks = sum(2 * run["duration_s"] / TICK for run in runs)
        together = sum(2 * run["together_s"] for run in runs) / 60
        cells = [
            f"`{motion}`: {what}",
            f"{mean([of['person'] for of in moves]):.2f} m/s",
            f"{mean([of['workpiece'] for of in moves]):.2f} m/s",
            f"{mean([of['workpiece'] / of['person'] for of in moves]):.2f} ({max(of['workpiece'] / of['person'] for of in moves):.2f})",
            f"{mean([run['score_mean_on'] for run in runs]):.2f}, {mean([run['score_mean_off'] for run in runs]):.2f}",
            f"{sum(run['retreats'] for run in runs) / together:.0f}",
            f"{sum(run['separation_violations'] for run in runs)} of {ticks / 1e6:.1f} million",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def people(programs, folder):
    """The table of other people, paths and movements."""
    heads = [
        "person", "on the spot: trunk", "workpiece then (worst)", "base at rest then", "2 s after standing began: workpiece",
        "e_s with ergonomics and without", "outside the shared workspace", "ticks too near",
    ]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]

    def play(case):
        index, seed = case
        made = [*PEOPLE[index][1], "--seed", str(seed)]
        return summary(programs, f"{index}-{seed}", folder, made, [])

    seeds = range(1, EACH + 1)
    played = at_once("run", play, [(index, seed) for index in range(len(PEOPLE)) for seed in seeds])
    for index, (what, _) in enumerate(PEOPLE):
        runs = played[index * EACH : (index + 1) * EACH]

        def cell(part, name, factor, unit, worst=None):
            values = [factor * run["calmness"][part][name] for run in runs if run["calmness"][part]]
            if not values:
                return "–"
            most = "" if worst is None else f" ({worst(values):.0f})"
            return f"{sum(values) / len(values):.0f}{most} {unit}"

        mean = lambda name: sum(run[name] for run in runs) / len(runs)
        ticks = sum(2 * run["duration_s"] / TICK for run in runs)
        cells = [
            what,
            cell("on_the_spot", "person", 1e3, "mm/s"),
            cell("on_the_spot", "workpiece", 1e3, "mm/s", max),
            cell("on_the_spot", "base_at_rest", 1e2, "%"),
            cell("settled", "workpiece", 1e3, "mm/s"),
            f"{mean('score_mean_on'):.2f}, {mean('score_mean_off'):.2f}",
            f"{mean('outside_s_on'):.1f} s",
            f"{sum(run['separation_violations'] for run in runs)} of {ticks / 1e6:.1f} million",
        ]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def motion(part, name, factor=1.0):
    """A function that reads a number of the calmness of a summary; None where it is not known."""

    def read(run):
        value = (run["calmness"][part] or {}).get(name)
        return None if value is None else factor * value

    return read


WALKING = motion("walking", "workpiece_p99", 1e3)


def over_quiet(run):
    """The speed of the workpiece over that without noise; None for a run that keeps no distances, unlike that one."""
    speed, quiet = WALKING(run), WALKING(run["quiet"])
    return speed / quiet if run["separation"] and speed is not None and quiet else None


# Label, digits, unit, which of the recordings is the worst, the number of a summary, the floor of its mean, and another
# floor without noise. The mean is to be at least the floor if the worst is the least, and otherwise at most.
ROWS = [
    ("standing, 1 s after it began: workpiece, root mean square", 0, " mm/s", max, motion("standing", "workpiece", 1e3), 20, 8),
    ("standing: workpiece, 99 %", 0, " mm/s", max, motion("standing", "workpiece_p99", 1e3), 70, None),
    ("2 s after it began: workpiece, root mean square", 0, " mm/s", max, motion("settled", "workpiece", 1e3), 12, None),
    ("2 s after it began: workpiece, 99 %", 0, " mm/s", max, motion("settled", "workpiece_p99", 1e3), 45, None),
    ("standing: base at rest", 0, " %", min, motion("standing", "base_at_rest", 1e2), 92, 98),
    ("standing: base at its acceleration limit", 1, " %", max, motion("standing", "base_at_limit", 1e2), 3, None),
    ("standing: reversals of the base", 1, "/s", max, motion("standing", "base_reversals"), 0.5, None),
    (r"standing: joints, root mean square of $\lVert \dot q \rVert$", 2, " rad/s", max, motion("standing", "joints"), 0.08, None),
    ("walking: base at its acceleration limit", 0, " %", max, motion("walking", "base_at_limit", 1e2), 30, None),
    ("walking: reversals of the base", 1, "/s", max, motion("walking", "base_reversals"), 3, None),
    ("walking: workpiece, 99 %", 0, " mm/s", max, WALKING, None, None),
    ("the same over that without noise", 2, "", max, over_quiet, 1.25, None),
    ("begins to follow after the person", 2, " s", max, motion("following", "onset"), 0.45, None),
    ("lag behind its place while walking", 0, " mm", max, motion("following", "lag", 1e3), 150, None),
    ("tracking error, standing", 1, " mm", max, motion("standing", "tracking_error", 1e3), 4, None),
    ("tracking error, walking", 1, " mm", max, motion("walking", "tracking_error", 1e3), 8, None),
    ("$e_s$, mean", 2, "", max, lambda run: run["score_mean_on"], 0.22, None),
    ("of it because the frame is held", 3, "", max, lambda run: run["score_of_hold_on"], None, None),
    ("$e_s$ without ergonomics / with", 1, "", min, lambda run: run["score_mean_off"] / run["score_mean_on"], 3, None),
    ("outside the shared workspace", 1, " s", max, lambda run: run["outside_s_on"], 1.5, None),
    ("retreats, with ergonomics and without", 1, "", max, lambda run: run["retreats"], None, None),
]
MISSED = " ✗"


def cell(values, digits, unit, worst, floor):
    """Mean and worst of the values, marked if the mean, as it is printed, misses the floor."""
    values = [value for value in values if value is not None]
    if not values:
        return "–"
    # Adding zero removes the sign of a zero that comes from rounding.
    mean = f"{round(sum(values) / len(values), digits) + 0.0:.{digits}f}"
    missed = floor is not None and worst(float(mean), floor) != floor
    return f"{mean} ({worst(values):.{digits}f}){unit}{MISSED if missed else ''}"


def table(runs):
    """The table of the summaries of all recordings."""
    heads = [f"mean of {len(runs)} recordings (the worst of them)", "floor", *(heading for heading, *_ in COLUMNS)]
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    for label, digits, unit, worst, number, floor, quiet in ROWS:
        sign = "≥" if worst is min else "≤"
        without = "" if quiet is None else f" (no noise: {quiet})"
        cells = [label, "" if floor is None else f"{sign} {floor}{unit}{without}"]
        for column in range(len(COLUMNS)):
            own = floor if column != QUIET or quiet is None else quiet
            cells.append(cell([number(run[column]) for run in runs], digits, unit, worst, own))
        lines.append("| " + " | ".join(cells) + " |")
    ticks = sum(2 * run[0]["duration_s"] / TICK for run in runs)
    cells = [f"ticks too near to the true person, with ergonomics and without, of {ticks / 1e6:.1f} million", "0"]
    for column, (*_, options) in enumerate(COLUMNS):
        near = sum(run[column]["separation_violations"] for run in runs)
        cells.append("not judged" if "--no-separation" in options else f"{near}{MISSED if near else ''}")
    return "\n".join([*lines, "| " + " | ".join(cells) + " |"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--recordings", type=int, default=20, help="how many, 20 by default")
    parser.add_argument("--programs", type=pathlib.Path, help="folder of `record` and `follow`")
    parser.add_argument("--real", action="store_true", help="the table of people who move as real ones")
    parser.add_argument("--people", action="store_true", help="the table of other statures, paths and movements")
    parser.add_argument("--print", action="store_true", help="print the table instead of writing it into the page")
    arguments = parser.parse_args()
    programs = arguments.programs or ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "release"
    if not arguments.programs:
        build = ["cargo", "build", "--release", "--locked", "-p", "examples", "--bin", "record", "--bin", "follow"]
        subprocess.run(build, cwd=ROOT, check=True)
    with tempfile.TemporaryDirectory() as folder:
        if arguments.real:
            name, command, text = "real", "python3 docs/calmness.py --real", real(programs.resolve(), pathlib.Path(folder))
        elif arguments.people:
            name, command, text = "people", "python3 docs/calmness.py --people", people(programs.resolve(), pathlib.Path(folder))
        else:
            for noise in {noise or 1.0 for _, noise, *_ in COLUMNS}:
                settings(programs.resolve(), noise, pathlib.Path(folder))
            seeds = range(1, arguments.recordings + 1)
            runs = at_once("recording", lambda seed: play(programs.resolve(), seed, pathlib.Path(folder)), seeds)
            name, command, text = "calmness", "python3 docs/calmness.py", table(runs)
    if arguments.print:
        print(text)
    else:
        date = datetime.date.today().isoformat()
        write_block(PAGE, name, f"`{command}`, {date}, {machine()}:\n\n{text}\n")


if __name__ == "__main__":
    main()
