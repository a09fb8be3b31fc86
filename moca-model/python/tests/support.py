"""Support that several tests need."""

import os
import pathlib
import subprocess
import sys

import numpy as np

# The tests may be run away from the sources, so that these are not what is imported.
WORKSPACE = pathlib.Path(os.environ.get("AHQP_WORKSPACE", pathlib.Path(__file__).parents[3]))
PACKAGE = WORKSPACE / "moca-model/python"
PANDA = WORKSPACE / "moca-model/whole-body/examples/urdf/panda.urdf"


def run_example(name, *options):
    """Output of an example of this folder."""
    command = [sys.executable, PACKAGE / "examples" / f"{name}.py", *options]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def run_rust_example(name, package="whole-body"):
    """Output of an example of a package: the binary in AHQP_RUST_EXAMPLES, or one that is built now."""
    folder = os.environ.get("AHQP_RUST_EXAMPLES")
    command = ["cargo", "run", "-q", "--locked", "-p", package, "--example", name]
    if folder:
        command = [pathlib.Path(folder) / name]
    run = subprocess.run(command, check=True, capture_output=True, text=True, cwd=WORKSPACE)
    return run.stdout


def problem(rng, n=6):
    """A hierarchy of random rows with bounds, as levels (A, lower, upper)."""
    levels = []
    for rows in (3, 2, 3):
        matrix = rng.normal(size=(rows, n))
        middle = rng.normal(size=rows)
        width = rng.choice([0.0, 1.0], size=rows)
        levels.append((matrix, middle - width, middle + width))
    return levels


def lexicographic(levels, x):
    """The violation of each level at x."""
    distances = [np.maximum(np.maximum(low - a @ x, a @ x - high), 0.0) for a, low, high in levels]
    return [float(np.linalg.norm(distance)) for distance in distances]
