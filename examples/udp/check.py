"""Checks robots in lockstep with their controller, robot.py and others: check.py DRIVE [ROBOT]..., their programs."""
import json
import pathlib
import subprocess
import sys

SECONDS = 12  # of the built-in recording: the person has engaged, and the robot comes
ROBOT = [sys.executable, "-B", str(pathlib.Path(__file__).with_name("robot.py"))]


def check(drive, robot):
    """Plays once, fails with what is wrong, and returns where the joints are at the end."""
    name = pathlib.Path(robot[-1]).name
    with subprocess.Popen([*robot, "127.0.0.1:0"], stdout=subprocess.PIPE, text=True) as robot:
        try:
            home = [0.0, 0.0, 0.0, 0.0, -0.785398, 0.0, -2.356194, 0.0, 1.570796, 0.785398]
            address = robot.stdout.readline().split()[-1]
            command = [drive, "--robot", address, "--lockstep", "--compensation", "franka", "--quiet", "--json"]
            command += ["--duration", str(SECONDS)]
            output = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
            report = json.loads(output.splitlines()[-1])
            commands, joints = robot.stdout.readline().split(" commands; joints at ")
            assert robot.wait() == 0, "the robot failed"
        finally:
            robot.kill()
    faults = [fault["fault"] for fault in report["faults"]]
    assert (report["ended"], report["at_rest"], faults) == ("requested", True, ["stop requested"]), report
    assert report["missed"] == report["unmeasured"] == 0 and not report["link"]["refused"], report
    assert report["ticks"] == int(commands) > 990 * SECONDS, f"{commands} commands"
    moved = max(abs(q - q0) for q, q0 in zip(map(float, joints.split()), home, strict=True))
    assert moved > 0.1, f"the robot stood still at {joints}"
    print(f"{name} took {commands} commands and moved a joint by {moved:.2f} m or rad")
    return [float(q) for q in joints.split()]


if __name__ == "__main__":
    ends = [check(sys.argv[1], robot) for robot in [ROBOT, *([program] for program in sys.argv[2:])]]
    # They are the same robot, so the same commands bring them to the same place.
    for end in ends:
        assert all(abs(a - b) < 1e-6 for a, b in zip(end, ends[0], strict=True)), ends
