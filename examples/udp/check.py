"""Checks robot.py in lockstep with its controller: check.py PROGRAM, the program `drive`."""
import json
import pathlib
import subprocess
import sys

SECONDS = 12  # of the built-in recording: the person has engaged, and the robot comes
ROBOT = [sys.executable, "-B", str(pathlib.Path(__file__).with_name("robot.py")), "127.0.0.1:0"]


def check(drive):
    """Plays once, and fails with what is wrong."""
    with subprocess.Popen(ROBOT, stdout=subprocess.PIPE, text=True) as robot:
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
    print(f"a robot in Python took {commands} commands and moved a joint by {moved:.2f} m or rad")


if __name__ == "__main__":
    check(sys.argv[1])
