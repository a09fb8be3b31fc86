"""Runs the paper's Experiment 3 between two nodes: one is the robot with its gripper, its cameras and the person before
them, the other its controller.

It fails unless the person hands the object over, and the robot grasps it, turns it, and shows the right surface, without
a protective stop. `check.sh` says how to run it.
"""

import argparse
import collections
import json
import os
import signal
import subprocess
import sys

# What happens, in this order; other phases may lie between.
EXPECTED = ["handover", "grasping", "working", "turning to the back: drilled is shown", "working: the right surface is shown"]


def missing(labels: list) -> list:
    """The first phases of those expected that did not come in their order."""
    rest = iter(labels)
    return [phase for phase in EXPECTED if not any(label.startswith(phase) for label in rest)][:1]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drive", required=True, help="the program, built with the feature ros2")
    parser.add_argument("--recording", required=True, help="somebody who offers an object")
    parser.add_argument("--duration", type=float, default=24.0, help="how long [s]; default 24")
    parser.add_argument("--priority", type=int, help="real-time priority of loop and robot, on a machine that does more")
    options = parser.parse_args()
    both = [options.drive, "--ros2", "--recording", options.recording, "--object", "offered-drilled", "--quiet"]
    # Camera, gripper and planning have none, as beside a robot.
    both += [f"--priority={options.priority}"] if options.priority else []
    robot = subprocess.Popen([*both, "--serve"], stdout=subprocess.PIPE, text=True)
    drive = [*both, "--compensation", "nothing", "--json", f"--duration={options.duration}"]
    drive = subprocess.run(drive, stdout=subprocess.PIPE, text=True, check=False)
    robot.send_signal(signal.SIGINT)
    robot.communicate(timeout=10)
    if not drive.stdout.strip():
        print("drive printed nothing", file=sys.stderr)
        return 1
    report = json.loads(drive.stdout.splitlines()[-1])
    spans = report["phase"]["spans"]
    for span in spans:
        print(f"{span['begin']:7.2f} s  {span['label']}")
    topics = {topic["topic"]: topic for topic in report["ros2"]["topics"]}
    for name in ("/body_joints", "/action", "/surface"):
        print(f"{name:20} {topics[name]['taken']} taken, {topics[name]['lost']} lost, refused {topics[name]['refused']}")
    faults = collections.Counter(fault["fault"] for fault in report["faults"])
    print(f"protective stops     {report['protective_stops']}; faults {dict(faults)}")
    print(f"ticks                {report['ticks']}, missed {report['missed']}, unmeasured {report['unmeasured']}")
    print(f"load average         {os.getloadavg()[0]:.2f}, on {os.cpu_count()} processors")
    wrong = [f"not reached: {phase}" for phase in missing([span["label"] for span in spans])]
    if drive.returncode != 0 or report["ended"] != "requested":
        wrong.append(f"drive ended with {drive.returncode}: {report['ended']}")
    if report["protective_stops"]:
        wrong.append("the robot stopped for the person")
    print("all is well" if not wrong else "\n".join(["wrong:", *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
