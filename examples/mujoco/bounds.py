#!/usr/bin/env python3
"""Judges what the controller makes of measurements that are missing, frozen, late or seldom, by MuJoCo's true joints.

    python3 examples/mujoco/bounds.py --programs target/debug              # 6 moments, a minute
    python3 examples/mujoco/bounds.py --programs target/debug --moments 50 --table rows.json

Needs numpy and mujoco (PyPI). The exit status is 1 if a bound does not hold.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tempfile

import numpy as np

from lockstep import Trouble, play
from robot import ARM, SPEED, compile_model

RECORDING = pathlib.Path(__file__).resolve().parents[1] / "recordings" / "follow.jsonl"
WARM_UP = 2.5  # s before a moment: the robot sets out from its home meanwhile
SEED = 20
FASTER, BEYOND = 1.2, 0.1  # no joint above 1.2 times its speed when it began, and 0.1 m/s or rad/s
NAMED_WITHIN = 10  # ms
BRIDGED = 3  # ms without a fault
ERROR = 0.05  # rad: the largest following error
OVERSHOOT = 1.15  # of a joint's largest speed
SILENCES = [("silent", 3), ("silent", 5), ("silent", 19), ("silent", 100), ("silent", None)]
FROZEN = [("frozen", 3), ("frozen", 19), ("frozen", 100), ("frozen", None)]
LOST = [("lost", 5), ("lost", 19), ("lost", 100), ("lost", None)]
STEADY = [(1, 1), (1, 2), (1, 4), (0, 1), (2, 1), (3, 1), (4, 1), (4, 4)]  # delay [ms], a measurement every [ms]
REFUSED = [(1, 5), (1, 10), (6, 1), (8, 1), (15, 1)]


class Bench:
    """Recordings, map and programs of all runs."""

    def __init__(self, programs, folder):
        self.drive, self.folder, self.model = programs / "drive", folder, compile_model()
        lines = RECORDING.read_text().splitlines()
        self.header, self.frames = lines[0], [json.loads(line) for line in lines[1:-1]]
        command = [programs / "ergo_map", "--preset", "average", "--spacing", "0.1", "--output", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        self.ergonomics = next(folder.glob("*.ergomap"))

    def recording(self, begin):
        """Returns the file of the recording from `begin` [s] on."""
        file = self.folder / f"from-{begin:.3f}.jsonl"
        frames = [{**frame, "time": frame["time"] - begin} for frame in self.frames if frame["time"] >= begin]
        end = {"end": {"frames": len(frames), "complete": True}}
        file.write_text("\n".join([self.header, *map(json.dumps, frames), json.dumps(end)]) + "\n")
        return file

    def play(self, begin, seconds, **options):
        recording = self.recording(begin)
        return play(self.drive, self.model, recording=recording, ergonomics=self.ergonomics, seconds=seconds, **options)


def moments(bench, count):
    """Returns random times of the recording [s]."""
    random = np.random.default_rng(SEED)
    last = bench.frames[-1]["time"] - 6
    return (np.arange(count) + random.random(count)) * last / count


def judge_trouble(bench, kind, ticks, times):
    """Returns the row of a trouble: how much too fast a joint becomes at worst, and when a fault is named."""
    worst, latest, unnamed, names = -np.inf, 0, 0, set()
    begin = round(1000 * WARM_UP)
    # What ends sooner than a fault is followed by whatever the robot is told.
    judged = ticks if ticks and ticks <= NAMED_WITHIN else (ticks or 400) + 100
    for index, time in enumerate(times):
        trouble = Trouble(kind, begin, ticks)
        seconds = (begin + judged) / 1000 + 0.1
        run = bench.play(time, seconds, seed=index, troubles=[trouble])
        speed = np.abs(run.velocity)
        excess = speed[begin : begin + judged] - (FASTER * speed[begin - 1] + BEYOND)
        worst = max(worst, excess.max())
        fault = run.first_fault(begin, begin + judged)
        if fault is None:
            unnamed += 1
        else:
            names.add(fault[0])
            latest = max(latest, fault[1] - begin + 1)
        early = run.first_fault(0, begin)
        if early:
            print(f"    moment {index} at {time:.2f} s: {early[0]} in tick {early[1]}, before anything was wrong")
        if excess.max() > 0:
            joint = np.unravel_index(excess.argmax(), excess.shape)
            print(f"    moment {index} at {time:.2f} s: joint {joint[1]} {excess.max():.3f} beyond after {joint[0] + 1} ms")
    row = {"kind": kind, "ms": ticks, "beyond": worst, "fault": latest, "unnamed": unnamed, "names": sorted(names)}
    wrong = []
    if worst > 0:
        wrong.append(f"{worst:.3f} rad/s beyond")
    if kind != "lost":
        if ticks == BRIDGED and unnamed < len(times):
            wrong.append(f"a fault for {ticks} ms: {names}")
        if (ticks is None or ticks > NAMED_WITHIN) and (unnamed or latest > NAMED_WITHIN):
            wrong.append(f"no fault in {unnamed}, the latest after {latest} ms")
    return row, wrong


def judge_steady(bench, delay, every, seconds):
    """Returns the row of a rate and a delay that are borne."""
    run = bench.play(0.0, seconds, seed=1, delay=delay, every=every)
    row = {"delay": delay, "every": every}
    if run.refusal:
        return row, [f"refused: {run.refusal}"]
    speed = np.abs(run.velocity)[:, ARM] / SPEED[ARM]
    error = np.array(run.error)
    faults = run.report["faults"]
    row |= {"error": error.max(), "rms": float(np.sqrt((error**2).mean())), "speed": speed.max()}
    wrong = [f"{fault['fault']} at {fault['begin']} s" for fault in faults[:3]]
    if error.max() > ERROR:
        wrong.append(f"a following error of {error.max():.3f} rad")
    if speed.max() > OVERSHOOT:
        wrong.append(f"{speed.max():.2f} of the speeds")
    return row, wrong


def judge_refused(bench, delay, every):
    """Returns the row of a rate or a delay that is refused before the arm moves."""
    run = bench.play(0.0, 1.0, seed=1, delay=delay, every=every)
    row = {"delay": delay, "every": every, "refusal": run.refusal.splitlines()[-1] if run.refusal else ""}
    expected = "ms late" if every == 1 else "measures every"
    return row, [] if expected in run.refusal else [f"not refused: {run.report or run.refusal}"]


def judge_carrying(bench):
    """Before it moves the arm is told the torques that MuJoCo says carry it; the same run twice is the same."""
    runs = [bench.play(0.0, 0.5, seed=1) for _ in range(2)]
    off = np.abs(runs[0].torque[0] - runs[0].gravity).max()
    wrong = [] if off < 0.2 else [f"{off:.3f} Nm from what MuJoCo says that carries the arm"]
    if runs[0].commands != runs[1].commands:
        wrong.append("the same run twice sent other commands")
    return {"off": off}, wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--programs", type=pathlib.Path, required=True, help="the folder with drive and ergo_map")
    parser.add_argument("--moments", type=int, default=6, help="moments of the run at which each trouble begins")
    parser.add_argument("--seconds", type=float, default=6.0, help="of each run with a rate and a delay")
    parser.add_argument("--only", default="", help="troubles whose kind this is, or `steady`")
    parser.add_argument("--table", type=pathlib.Path, help="write the rows here, for table.py")
    options = parser.parse_args()
    rows, failures = {"carrying": [], "trouble": [], "steady": [], "refused": []}, 0

    def note(what, result):
        nonlocal failures
        row, wrong = result
        failures += len(wrong)
        rows[what].append(row)
        shown = ", ".join(f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items())
        print(f"{what}: {shown}" + "".join(f"\n  WRONG: {each}" for each in wrong), flush=True)

    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(options.programs.resolve(), pathlib.Path(folder))
        times = moments(bench, options.moments)
        if options.only in ("", "steady"):
            note("carrying", judge_carrying(bench))
            for delay, every in STEADY:
                note("steady", judge_steady(bench, delay, every, options.seconds))
            for delay, every in REFUSED:
                note("refused", judge_refused(bench, delay, every))
        for kind, ticks in SILENCES + FROZEN + LOST:
            if options.only in ("", kind):
                note("trouble", judge_trouble(bench, kind, ticks, times))
    if options.table:
        options.table.write_text(json.dumps(rows, indent=1, default=float) + "\n")
    print(f"{failures} bounds do not hold" if failures else "all bounds hold")
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
