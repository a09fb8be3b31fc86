#!/usr/bin/env python3
"""Holds whole-body against Pinocchio on the public robots of example-robot-data.

    python3 -m venv venv && venv/bin/pip install pin example-robot-data
    cargo build --release -p whole-body --example dynamics_of_states
    venv/bin/python moca-model/whole-body/tests/golden/cross_check.py \
        --program target/release/examples/dynamics_of_states

Every URDF of the package is read, each robot on a fixed base and on a floating one, the first ten
also on a planar one, in 100 random states each. Prints a line a robot and the worst error of each
quantity: the largest difference of an entry over the largest entry, or over 1 if that is smaller.
What divides by a mass matrix of a condition number above 1e8 is printed and not judged: icub.urdf has
links of 1e-17 kg m2.
"""

import argparse
import json
import pathlib
import subprocess
import sys

import numpy as np
import pinocchio as pin

from reference import Robot

FLOOR = 1e-9
# Mimics joints that it does not have; Pinocchio takes its followers for free joints.
BROKEN = ("alex_psyonic_hands",)
LEFT_OUT = ("frames", "bias", "torque")


def error(ours, theirs):
    ours = np.asarray(ours, dtype=float).ravel()
    theirs = np.asarray(theirs, dtype=float).ravel()
    return np.abs(ours - theirs).max(initial=0.0) / max(1.0, np.abs(theirs).max(initial=0.0))


def check(program, urdf, base, states, source):
    robot = Robot(urdf, base)
    if base == "fixed" and not robot.joints:
        raise ValueError("no joint: not on a fixed base")
    frames = list(source.choice(robot.links, size=min(5, len(robot.links)), replace=False))
    request = {
        "urdf": str(urdf),
        "base": base,
        "frames": frames,
        "states": [robot.random_state(source) for _ in range(states)],
    }
    run = subprocess.run([program], input=json.dumps(request), capture_output=True, text=True)
    if run.returncode != 0:
        return robot, run.stderr.strip()
    answer = json.loads(run.stdout)
    moving = answer["joints"][{"fixed": 0, "planar": 3, "floating": 1}[base] :]
    worst = {}
    for state, ours in zip(request["states"], answer["states"]):
        theirs = robot.values(state, frames, moving)
        pairs = [(key, ours[key], value) for key, value in theirs.items() if key not in LEFT_OUT]
        for own, their in zip(ours["frames"], theirs["frames"]):
            pairs += [(key, own[key], value) for key, value in their.items()]
        for key, own, their in pairs:
            # A joint that moves nothing: we say so, Pinocchio divides by zero or by rounding.
            if own is None and key in ("forward_dynamics", "effective_mobility"):
                assert np.linalg.cond(theirs["mass_matrix"]) > 1e12, key
                continue
            # Links of hardly any inertia: rounding in a torque decides on the acceleration.
            if key in ("forward_dynamics", "effective_mobility"):
                if np.linalg.cond(theirs["mass_matrix"]) > 1e8:
                    key = "ill-conditioned " + key
            worst[key] = max(worst.get(key, 0.0), error(own, their))
            if not np.isfinite(worst[key]):
                worst[key] = float("inf")
    return robot, worst


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", required=True)
    parser.add_argument("--states", type=int, default=100)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    prefix = pathlib.Path(pin.__file__).parents[4]
    robots = sorted((prefix / "share/example-robot-data/robots").glob("**/*.urdf"))
    source = np.random.default_rng(20240607)
    total, failed, planar = {}, [], 0
    for urdf in robots:
        if arguments.only not in urdf.name or urdf.stem in BROKEN:
            continue
        bases = ["fixed", "floating"] + (["planar"] if planar < 10 else [])
        for base in bases:
            name = f"{urdf.stem} {base}"
            try:
                robot, worst = check(arguments.program, urdf, base, arguments.states, source)
            except Exception as problem:  # Pinocchio refuses some.
                print(f"{name:45} left out: {str(problem).splitlines()[0]}")
                continue
            if isinstance(worst, str):
                print(f"{name:45} refused: {worst}")
                failed.append(name)
                continue
            planar += base == "planar"
            print(f"{name:45} nv {robot.model.nv:3}  mimics {len(robot.mimics):2}  "
                  f"worst {max(worst.values()):.1e} {max(worst, key=worst.get)}")
            for key, value in worst.items():
                if value > total.get(key, (0.0, ""))[0]:
                    total[key] = (value, name)
            judged = [value for key, value in worst.items() if "ill-conditioned" not in key]
            if not max(judged) <= FLOOR:
                failed.append(name)
    for key, (value, name) in sorted(total.items()):
        print(f"{key:36} {value:.2e}  {name}")
    print("above the floor or refused:", failed or "none")
    sys.exit(bool(failed))


if __name__ == "__main__":
    main()
