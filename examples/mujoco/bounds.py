#!/usr/bin/env python3
"""Judges what the controller makes of measurements that are missing, frozen, late or seldom, by MuJoCo's true joints.

    python3 examples/mujoco/bounds.py --programs target/debug              # 3 moments, a minute
    python3 examples/mujoco/bounds.py --programs target/debug --moments 50 --rows rows.json

Needs numpy and mujoco (PyPI). The exit status is 1 if a bound does not hold.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tempfile
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import numpy as np

from lockstep import Trouble, play
from robot import ARM, SPEED, compile_model

RECORDING = pathlib.Path(__file__).resolve().parents[1] / "recordings" / "follow.jsonl"
PLACES = pathlib.Path(__file__).with_name("places.csv")  # where the robot is in the run, by time: see --places
WARM_UP = 1500  # ms at least before a moment, in which the robot sets out from where it is in the run
SEED = 20
FASTER, BEYOND = 1.2, 0.1  # no joint above 1.2 times its speed when it began, and 0.1 m/s or rad/s
NAMED_WITHIN = 10  # ms
BRIDGED = 3  # ms without a fault
ERROR = 0.05  # rad: the largest following error
OVERSHOOT = 1.15  # of a joint's largest speed
# Troubles of one run, one after the other [ms]; none lasts for ever. Of one that lasts long the loop ends.
TROUBLES = [
    ("silent", (3, 5, 19)),
    ("silent", (100,)),
    ("silent", (None,)),
    ("frozen", (3, 19)),
    ("frozen", (100,)),
    ("frozen", (None,)),
    ("lost", (5, 19)),
    ("lost", (100,)),
    ("lost", (None,)),
]
APART = 400  # ms from one to the next
STEADY_FROM = 20.0  # s of the recording: the robot sets out at once, and fast, from its home
STEADY = [(1, 1), (1, 2), (1, 4), (0, 1), (2, 1), (3, 1), (4, 1), (4, 4)]  # delay [ms], a measurement every [ms]
REFUSED = [(1, 5), (1, 10), (5, 1), (6, 1), (8, 1), (15, 1)]


class Bench:
    """Recordings, map and programs of all runs."""

    def __init__(self, programs, folder):
        self.drive, self.folder, self.model = programs / "drive", folder, compile_model()
        lines = RECORDING.read_text().splitlines()
        self.header, self.frames = lines[0], [json.loads(line) for line in lines[1:-1]]
        command = [programs / "ergo_map", "--preset", "average", "--spacing", "0.1", "--quiet", "--output", folder]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        self.ergonomics = next(folder.glob("*.ergomap"))

    def recording(self, begin):
        """Returns the file of the recording from `begin` [s] on."""
        file = self.folder / f"from-{begin:.3f}-{os.getpid()}.jsonl"
        frames = [{**frame, "time": frame["time"] - begin} for frame in self.frames if frame["time"] >= begin]
        end = {"end": {"frames": len(frames), "complete": True}}
        file.write_text("\n".join([self.header, *map(json.dumps, frames), json.dumps(end)]) + "\n")
        return file

    def play(self, begin, seconds, **options):
        recording = self.recording(begin)
        return play(self.drive, self.model, recording=recording, ergonomics=self.ergonomics, seconds=seconds, **options)

    def write_places(self):
        """Plays the whole run, and writes where the robot is in it each half second."""
        run = self.play(0.0, self.frames[-1]["time"], seed=SEED)
        places = list(enumerate(run.position))[::500]
        rows = [",".join([f"{tick / 1000}", *(f"{q:.4f}" for q in place)]) for tick, place in places]
        PLACES.write_text("\n".join(["time,x,y,yaw,q1,q2,q3,q4,q5,q6,q7", *rows]) + "\n")


def moments(count):
    """Returns moments of the run: number, second from which on it is played, place there, and tick of the moment."""
    places = np.loadtxt(PLACES, delimiter=",", skiprows=1)
    # Not while nobody is there, at its beginning and end.
    places = places[(places[:, 0] >= 3) & (places[:, 0] <= 50)]
    random = np.random.default_rng(SEED)
    chosen = places[((np.arange(count) + random.random(count)) * len(places) / count).astype(int)]
    ticks = WARM_UP + random.integers(0, 500, count)
    return [(index, row[0], row[1:], tick) for index, (row, tick) in enumerate(zip(chosen, ticks.tolist()))]


def judged(ticks):
    """Returns for how many ticks from its beginning on a trouble is judged.

    What ends sooner than a fault is followed by whatever the robot is told.
    """
    return ticks if ticks and ticks <= NAMED_WITHIN else (ticks or 400) + 100


def suffer(bench, kind, lengths, moment):
    """Returns of each trouble how much too fast a joint becomes, in which joint, and the first fault with its tick."""
    index, time, start, first = moment
    begins = [first + APART * place for place in range(len(lengths))]
    troubles = [Trouble(kind, begin, ticks) for begin, ticks in zip(begins, lengths)]
    end = (begins[-1] + judged(lengths[-1])) / 1000 + 0.1
    run = bench.play(time, end, seed=index, start=start, troubles=troubles)
    if early := run.first_fault(0, begins[0]):
        print(f"    moment {index} at {time:.2f} s: {early[0]} in tick {early[1]}, before anything was wrong")
    speed, found = np.abs(run.velocity), []
    for begin, ticks in zip(begins, lengths):
        window = speed[begin : begin + judged(ticks)]
        excess = window - (FASTER * speed[begin - 1] + BEYOND)
        tick, joint = np.unravel_index(excess.argmax(), excess.shape)
        if excess.max() > 0:
            beyond = f"joint {joint} {excess.max():.3f} beyond after {tick + 1} ms"
            print(f"    {kind} {ticks}, moment {index} at {time:.2f} s: {beyond}")
        fault = run.first_fault(begin, begin + judged(ticks))
        found.append((excess.max(), speed[begin - 1].max(), fault and (fault[0], fault[1] - begin + 1)))
    return found


def judge_trouble(kind, ticks, outcomes):
    """Returns the row of a trouble by its outcomes at all moments, and what is wrong."""
    worst = max(excess for excess, _, _ in outcomes)
    faults = [fault for _, _, fault in outcomes if fault]
    unnamed, latest = len(outcomes) - len(faults), max((tick for _, tick in faults), default=0)
    row = {"kind": kind, "ms": ticks, "moments": len(outcomes), "beyond": worst, "fault": latest, "unnamed": unnamed}
    row |= {"names": sorted({name for name, _ in faults}), "fastest": max(speed for _, speed, _ in outcomes)}
    wrong = [f"{worst:.3f} rad/s beyond"] if worst > 0.0 else []
    if ticks == BRIDGED and faults:
        wrong.append(f"a fault within {ticks} ms")
    if ticks not in (3, 5) and (unnamed or latest > NAMED_WITHIN):
        wrong.append(f"no fault at {unnamed} moments, the latest after {latest} ms")
    return row, wrong


def judge_steady(bench, delay, every, seconds):
    """Returns the row of a rate and a delay that are borne."""
    run = bench.play(STEADY_FROM, seconds, seed=1, delay=delay, every=every)
    row = {"delay": delay, "every": every}
    if run.refusal:
        return row, [f"refused: {run.refusal}"]
    speed = np.abs(run.velocity)[:, ARM] / SPEED[ARM]
    error = np.array(run.error)
    # The last one is the request to end.
    faults = run.report["faults"][:-1]
    row |= {"error": error.max(), "rms": float(np.sqrt((error**2).mean())), "speed": speed.max()}
    wrong = [f"{fault['fault']} at {fault['begin']} s" for fault in faults[:3]]
    if error.max() > ERROR:
        wrong.append(f"a following error of {error.max():.3f} rad")
    if speed.max() > OVERSHOOT:
        wrong.append(f"{speed.max():.2f} of the speeds")
    return row, wrong


def judge_refused(bench, delay, every, _seconds):
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
    parser.add_argument("--moments", type=int, default=3, help="moments of the run at which each trouble begins")
    parser.add_argument("--seconds", type=float, default=3.0, help="of each run with a rate and a delay")
    parser.add_argument("--only", default="", help="troubles whose kind this is, or `steady`")
    parser.add_argument("--places", action="store_true", help="only play the whole run, and write places.csv")
    parser.add_argument("--rows", type=pathlib.Path, help="write the rows here, for table.py")
    options = parser.parse_args()
    rows, failures = {"carrying": [], "trouble": [], "steady": [], "refused": []}, 0

    def note(what, result):
        nonlocal failures
        row, wrong = result
        failures += len(wrong)
        rows[what].append(row)
        cells = [f"{key} {value:.4g}" if isinstance(value, float) else f"{key} {value}" for key, value in row.items()]
        print(f"{what}: {', '.join(cells)}" + "".join(f"\n  WRONG: {each}" for each in wrong), flush=True)

    with tempfile.TemporaryDirectory() as folder, ProcessPoolExecutor() as pool:
        bench = Bench(options.programs.resolve(), pathlib.Path(folder))
        if options.places:
            return bench.write_places()
        times = moments(options.moments)
        # All runs are begun before the first is judged, so that no core waits.
        tasks, troubles = [], []
        if options.only in ("", "steady"):
            tasks.append(("carrying", pool.submit(judge_carrying, bench)))
            for what, judge, cases in (("steady", judge_steady, STEADY), ("refused", judge_refused, REFUSED)):
                tasks += [(what, pool.submit(judge, bench, *case, options.seconds)) for case in cases]
        for kind, lengths in TROUBLES:
            if options.only in ("", kind):
                troubles.append((kind, lengths, pool.map(partial(suffer, bench, kind, lengths), times)))
        for what, task in tasks:
            note(what, task.result())
        for kind, lengths, outcomes in troubles:
            for ticks, of_one in zip(lengths, zip(*outcomes)):
                note("trouble", judge_trouble(kind, ticks, of_one))
    if options.rows:
        options.rows.write_text(json.dumps(rows, indent=1, default=float) + "\n")
    print(f"{failures} bounds do not hold" if failures else "all bounds hold")
    sys.exit(failures > 0)


if __name__ == "__main__":
    main()
