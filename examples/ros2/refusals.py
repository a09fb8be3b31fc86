"""Plays a robot that publishes nothing right, and checks that `drive --ros2` says of each thing what is wrong with it.

It fails if a reason is missing, or if drive ends otherwise than it should. `check.sh` says how to run it.
"""

import argparse
import math
import subprocess
import sys
import time

from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic

import graph
import robot
from messages import Header, Odometry, Pose, PoseArray, String, Time, Twist


def joint_states() -> list:
    """One for each thing that can be wrong, and what drive should say."""
    short, missing, twice, nan, unstamped, simulated = (robot.joint_state(robot.HOME, [0.0] * 7) for _ in range(6))
    short.velocity = []
    missing.name[1] = "fr3_joint7"
    twice.name[0] = "panda_joint1"
    nan.position[3] = math.nan
    unstamped.header.stamp = Time()
    simulated.header.stamp = Time(12, 0)
    return [short, missing, twice, nan, unstamped, simulated, robot.joint_state(robot.HOME, [0.0] * 7)]


def stamped(frame: str) -> Header:
    return Header(Time.of(time.time_ns()), frame)


EXPECTED = [
    "0 numbers of velocity, expected 8",
    'no joint "panda_joint7" among ["panda_finger_joint1", "fr3_joint7"',
    'joint "panda_joint1" more than once',
    "position: a number that is not finite",
    "no stamp; give it the time of the system clock",
    "by a clock that is behind this machine's",
    "no odometry in the last 0.1 s",
    'in the frame "map", expected "odom"',
    "somebody has the type std_msgs/String there, expected nav_msgs/Odometry",
    "18 numbers of body joints, expected 25",
    "drilling",
    "somebody has the type geometry_msgs/Twist there, expected geometry_msgs/TwistStamped",
    "the robot has measured nothing for 5",
]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drive", required=True, help="the program, built with the feature ros2")
    options = parser.parse_args()
    participant, stranger = graph.participant(), graph.participant()
    states, base, body, action = (
        graph.writer(participant, name) for name in ["/joint_states", "/odom", "/body_joints", "/action"]
    )
    text = graph.writer(stranger, "/odom", String)
    unstamped = DataReader(stranger, Topic(stranger, "rt/cmd_vel", Twist), graph.RELIABLE)
    drive = subprocess.Popen(
        [options.drive, "--ros2", "--compensation", "nothing", "--quiet"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    while drive.poll() is None:
        for state in joint_states():
            states.write(state)
        base.write(Odometry(stamped("map"), "base_footprint"))
        body.write(PoseArray(stamped("odom"), [Pose()] * 18))
        action.write(String("drilling"))
        text.write(String("x: 1.0"))
        time.sleep(0.02)
    said = drive.stdout.read() + drive.stderr.read()
    del unstamped
    missing = [reason for reason in EXPECTED if reason not in said]
    print(said)
    print(f"drive has ended with {drive.returncode}; {len(EXPECTED) - len(missing)} of {len(EXPECTED)} reasons")
    for reason in missing:
        print(f"missing: {reason}")
    return 1 if missing or drive.returncode != 1 else 0


if __name__ == "__main__":
    sys.exit(main())
