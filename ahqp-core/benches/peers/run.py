#!/usr/bin/env python3
"""Prepares a comparison with other solvers and runs it; see README.md."""

import argparse
import contextlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import venv

HERE = pathlib.Path(__file__).resolve().parent
WORKSPACE = HERE.parents[2]


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--limit", type=int, default=400, help="most problems of a set")
    parser.add_argument("--rounds", type=int, default=3, help="how often each solver runs")
    parser.add_argument("--sets", nargs="*", default=[], help="sets of your own (.hqp)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the written problems")
    parser.add_argument("--lexls", help="the `lexls_hqp` binary; see lexls/README.md")
    parser.add_argument("--keep", help="folder to keep and to use again")
    parser.add_argument("--no-cascade", action="store_true", help="leave the cascades out")
    options = parser.parse_args()

    with contextlib.ExitStack() as stack:
        folder = pathlib.Path(options.keep or stack.enter_context(tempfile.TemporaryDirectory()))
        python = environment(folder / "venv")
        hqp = build()
        sets = options.sets or written_problems(folder / f"problems-{options.seed}", options.seed)
        command = [python, HERE / "compare.py", "--hqp", hqp, "--limit", str(options.limit)]
        command += ["--rounds", str(options.rounds)]
        command += ["--no-cascade"] if options.no_cascade else []
        command += ["--lexls", options.lexls] if options.lexls else []
        # One thread for each solver.
        threads = {name: "1" for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")}
        sys.exit(subprocess.run(command + sets, env=os.environ | threads).returncode)


def environment(folder):
    """A virtual environment with the other solvers."""
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    if not python.exists():
        venv.create(folder, with_pip=True)
        install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*install, "-r", HERE / "requirements.txt"], check=True)
    return python


def build():
    """The `hqp` binary."""
    cargo = ["cargo", "build", "--release", "--package", "examples", "--bin", "hqp"]
    subprocess.run(cargo, cwd=WORKSPACE, check=True)
    return target_folder() / "release" / "hqp"


def target_folder():
    return pathlib.Path(os.environ.get("CARGO_TARGET_DIR", WORKSPACE / "target"))


def written_problems(folder, seed):
    """The sets that `cargo bench` runs, and the published random comparison, as text."""
    if not folder.exists():
        cargo = ["cargo", "run", "--release", "--package", "ahqp-core", "--features", "testing"]
        cargo += ["--example", "write_problems", "--", folder, str(seed)]
        subprocess.run(cargo, cwd=WORKSPACE, check=True)
    # d_n10 before d_n160.
    def order(path):
        return [int(part) if part.isdigit() else part for part in re.split(r"(\d+)", path.stem)]

    return sorted(folder.glob("*.hqp"), key=order)


if __name__ == "__main__":
    main()
