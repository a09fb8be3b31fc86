"""Runs the cells of the notebook in which MOCA follows a person, and judges what MuJoCo says of the run.

    python notebook.py moca-model/python/examples/moca_in_mujoco.ipynb
"""

import json
import sys
import time
from pathlib import Path

import numpy as np

MOST_LINES = 60
# From hips to wrist of the robot: the work zone, the drill, half of the box, and what is aside [m].
FARTHEST = np.hypot(0.75 + 0.2 + 0.06, 0.5)
SPEED = np.array([1.5, 1.5, 3.0, 2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61])  # m/s, rad/s: the URDF's


def run(path):
    """Returns the names of the notebook, and the number of its lines of code."""
    cells = json.loads(Path(path).read_text())["cells"]
    code = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    names = {}
    for number, cell in enumerate(code, 1):
        exec(compile(cell, f"{path}, cell {number}", "exec"), names)
    return names, sum(1 for cell in code for line in cell.splitlines() if line.strip())


def findings(names, lines):
    """Gives what is wrong."""
    hand, person, base = np.array(names["paths"]).transpose(1, 0, 2)
    commands = names["commands"]
    # What the base drives before is its way to the person.
    begun = np.argmax(np.linalg.norm(np.diff(person, axis=0), axis=1) > 1e-5)
    distance = np.linalg.norm(hand - person, axis=1)[begun:]
    walk, drive = person[-1] - person[begun], base[-1] - base[begun]
    phases = list(dict.fromkeys(command.phase for command in commands))
    faults = {command.fault for command in commands} - {None}
    states = {command.safety for command in commands} - {"normal", "reduced"}
    speed = max(np.abs(command.velocity / SPEED).max() for command in commands)
    if phases != ["apart", "working", "walking"] or commands[-1].phase != "working":
        yield f"the phases are {phases}, and {commands[-1].phase} at the end"
    if faults or states:
        yield f"faults {faults}, safety states {states}"
    if not 0.2 < distance.min() <= distance.max() < FARTHEST:
        yield f"the hand is {distance.min():.2f} to {distance.max():.2f} m from the person's hips"
    if np.linalg.norm(walk) < 0.9 or np.linalg.norm(drive - walk) > 0.5 * np.linalg.norm(walk):
        yield f"the person walks {walk} m, the base drives {drive} m"
    if speed > 1.0 + 1e-9:
        yield f"a joint is told {speed:.3f} of its limit"
    if lines > MOST_LINES:
        yield f"{lines} lines; at most {MOST_LINES}"


if __name__ == "__main__":
    begun = time.process_time()
    names, lines = run(sys.argv[1])
    seconds = time.process_time() - begun
    found = list(findings(names, lines))
    print(f"the notebook: {lines} lines, {seconds:.1f} s of processor time", *found, sep="\n")
    sys.exit(bool(found))
