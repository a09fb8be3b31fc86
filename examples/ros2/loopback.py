"""Plays the robot of `drive --ros2` in Cyclone DDS, and counts what is lost and how long messages take.

It fails if a message is lost, or if one in a hundred takes longer than the limit. `check.sh` says how to run it.
"""

import argparse
import json
import os
import subprocess
import sys

from robot import Robot


def quantile(values: list, share: float) -> float:
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)] if ordered else float("nan")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--drive", required=True, help="the program, built with the feature ros2")
    parser.add_argument("--duration", type=float, default=60.0, help="how long [s]; default 60")
    parser.add_argument("--limit", type=float, default=2.0, help="latency of 99 in 100 [ms]; default 2")
    parser.add_argument("--priority", type=int, help="real-time priority of all processes, on a machine that does more")
    options = parser.parse_args()
    if options.priority:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(options.priority))
    command = [options.drive, "--ros2", "--interface", "velocity", "--json", "--quiet"]
    command += [f"--duration={options.duration}"]
    load = os.getloadavg()[0]
    with Robot() as robot:
        drive = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
        if not drive.stdout.strip():
            print("drive printed nothing", file=sys.stderr)
            return 1
        measured, obeyed = robot.results()
    report = json.loads(drive.stdout.splitlines()[-1])
    ros2 = report["ros2"]
    topics = {topic["topic"]: topic for topic in ros2["topics"]}
    states = topics["/joint_states"]
    # To halt, each is told once more.
    lost = {
        "/joint_states": states["lost"],
        "/odom": topics["/odom"]["lost"],
        "/cmd_vel": ros2["published"] + 1 - obeyed.twists,
        "arm commands": ros2["published"] + 1 - obeyed.joints,
    }
    refused = {name: topic["refused"] for name, topic in topics.items() if topic["refused"]}
    latency = {share: 1e3 * quantile(obeyed.latency, share) for share in (0.5, 0.99, 1.0)}
    age = states["age_us"]
    print(f"ended                {report['ended']}, at rest: {report['at_rest']}")
    print(f"ticks                {report['ticks']}, missed {report['missed']}, unmeasured {report['unmeasured']}")
    begun, took = (", ".join(f"{1e-3 * report[what][share]:.3f}" for share in ("p50", "p99", "max"))
                   for what in ("latency_us", "duration_us"))
    print(f"ticks p50 p99 max    late {begun} ms; took {took} ms")
    print(f"measurements         {measured.count} sent, {states['taken']} taken; {measured.late} periods late at the "
          f"robot's side, {1e3 * measured.longest:.1f} ms the longest gap")
    print(f"commands             {ros2['published']} published, {ros2['superseded']} superseded, "
          f"{obeyed.twists} and {obeyed.joints} came")
    print(f"persons              {topics['/body_joints']['taken']} taken")
    pose = measured.pose
    print(f"the base went to     {pose[0]:.3f} m, {pose[1]:.3f} m, {pose[2]:.3f} rad")
    print(f"lost                 {lost}")
    print(f"refused              {refused}")
    print(f"to drive [ms]        p50 {age['p50'] / 1e3:.3f}, p99 {age['p99'] / 1e3:.3f}, max {age['max'] / 1e3:.3f}")
    print(f"to the robot [ms]    p50 {latency[0.5]:.3f}, p99 {latency[0.99]:.3f}, max {latency[1.0]:.3f}")
    print(f"load average         {load:.2f} before, {os.getloadavg()[0]:.2f} after, on {os.cpu_count()} processors")
    wrong = []
    if drive.returncode != 0 or report["ended"] != "requested" or not report["at_rest"]:
        wrong.append(f"drive ended with {drive.returncode}")
    wrong += [f"{count} lost on {name}" for name, count in lost.items() if count != 0]
    wrong += [f"refused on {name}" for name in refused]
    if ros2["failed"] != 0:
        wrong.append(f"{ros2['failed']} commands not taken by DDS")
    # A NaN is no latency.
    for name, p99 in [("to drive", age["p99"] / 1e3), ("to the robot", latency[0.99])]:
        if not p99 <= options.limit:
            wrong.append(f"p99 {name} {p99:.3f} ms, limit {options.limit} ms")
    print("all is well" if not wrong else "\n".join(["wrong:", *wrong]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
