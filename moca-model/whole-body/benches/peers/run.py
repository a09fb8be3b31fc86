#!/usr/bin/env python3
"""Times whole-body beside Pinocchio's C++ in one run; see README.md."""

import argparse
import os
import pathlib
import re
import subprocess
import tempfile
import venv

HERE = pathlib.Path(__file__).resolve().parent
CRATE = HERE.parents[1]
URDFS = [CRATE.parent / "urdf/moca.urdf", CRATE / "tests/golden/humanoid.urdf"]
UNITS = {"ns": 1.0, "µs": 1e3, "ms": 1e6}
# Pinocchio, and the headers that its own include.
PACKAGES = ["pin", "cmeel-eigen", "cmeel-urdfdom-headers"]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--venv", help="a virtual environment to use, or to make and keep")
    parser.add_argument("--rounds", type=int, default=3, help="how often both take turns")
    parser.add_argument("--flags", default="", help="further flags of g++, such as -march=native")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        prefix = install(pathlib.Path(options.venv or f"{scratch}/venv"))
        program = compile_peer(prefix, pathlib.Path(scratch), options.flags.split())
        rounds = [(own(), peer(program)) for _ in range(options.rounds)]
    report(*({key: min(one[side][key] for one in rounds) for key in rounds[0][side]}
             for side in (0, 1)))


def install(folder):
    """Folders of the wheels' headers and libraries."""
    python = folder / "bin/python"
    if not python.exists():
        venv.create(folder, with_pip=True)
    subprocess.run([python, "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
    where = "import pinocchio as p; print(p.__version__, p.__file__)"
    version, path = subprocess.check_output([python, "-c", where], text=True).split()
    print(f"Pinocchio {version}")
    return pathlib.Path(path).parents[4]


def compile_peer(prefix, scratch, flags):
    program = scratch / "pinocchio_calls"
    command = ["g++", "-std=c++17", "-O3", "-DNDEBUG", *flags, HERE / "pinocchio_calls.cpp"]
    command += [f"-I{prefix}/include{folder}" for folder in ("", "/eigen3", "/urdfdom_headers")]
    command += [f"-L{prefix}/lib", f"-Wl,-rpath,{prefix}/lib", f"-Wl,-rpath-link,{prefix}/lib", "-o", program]
    # As Pinocchio's own build defines.
    command += ["-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30"]
    command += ["-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12"]
    command += ["-lpinocchio_default", "-lpinocchio_parsers"]
    subprocess.run(command, check=True)
    return program


def own():
    """Medians of `cargo bench`, by call and robot."""
    command = ["cargo", "bench", "--quiet", "--package", "whole-body", "--bench", "robot"]
    environment = os.environ | {"DIVAN_BYTES_FORMAT": "decimal", "NO_COLOR": "1"}
    text = subprocess.check_output(command, cwd=CRATE, text=True, env=environment)
    call, times = None, {}
    for line in text.splitlines():
        if found := re.match(r"[├╰]─ (\w+)", line):
            call = found[1]
        elif found := re.match(r"[│ ]+[├╰]─ (\w+) (.*)", line):
            value, unit = found[2].split("│")[2].split()
            times[call, found[1]] = float(value) * UNITS[unit]
    return times


def peer(program):
    lines = subprocess.check_output([program, *URDFS], text=True).splitlines()
    return {(call, robot): float(time) for call, robot, time in map(str.split, lines)}


def report(ours, theirs):
    print(f"{'ns a call':30} {'robot':10} {'whole-body':>11} {'Pinocchio':>10} {'ratio':>6}")
    for (call, robot), time in theirs.items():
        own_time = ours[call, robot]
        print(f"{call:30} {robot:10} {own_time:11.0f} {time:10.0f} {time / own_time:6.2f}")


if __name__ == "__main__":
    main()
