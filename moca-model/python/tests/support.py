"""Support that several tests need."""

import os
import pathlib
import struct
import subprocess
import sys
import zlib

import numpy as np

# The tests may be run away from the sources, so that these are not what is imported.
WORKSPACE = pathlib.Path(os.environ.get("AHQP_WORKSPACE", pathlib.Path(__file__).parents[3]))
PACKAGE = WORKSPACE / "moca-model/python"
PANDA = WORKSPACE / "moca-model/whole-body/examples/urdf/panda.urdf"
VISION = WORKSPACE / "vision-models/tests/data"


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


def png(pixels):
    """The bytes of a PNG: colours of uint8, or grey of uint16."""
    height, width = pixels.shape[:2]
    bits, kind = (8, 2) if pixels.dtype == np.uint8 else (16, 0)
    rows = pixels.astype(pixels.dtype.newbyteorder(">")).reshape(height, -1)
    lines = b"".join(b"\0" + row.tobytes() for row in rows)

    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    head = struct.pack(">IIBBBBB", width, height, bits, kind, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(lines)) + chunk(b"IEND", b"")
