#!/usr/bin/env python3
"""Time of one step of inverse kinematics of a Panda: Pink, mink and Placo, beside `Ik::step` in one run.

    python3 -m venv venv && venv/bin/pip install pin-pink mink quadprog daqp
    python3 -m venv placo-venv && placo-venv/bin/pip install placo
    venv/bin/python moca-model/whole-body/benches/peers/ik.py placo-venv/bin/python

Placo 0.10 needs an older Pinocchio than Pink 4, so it has an environment of its own: the peers of each
interpreter given are timed too. All have position and velocity limits; whole-body has acceleration and
jerk limits too, and strict priorities where the others weigh. Medians of 3000 steps in the middle of a
motion.
"""

import pathlib
import statistics
import subprocess
import sys
import time

import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
URDF = HERE.parents[1] / "examples" / "urdf" / "panda.urdf"
HOME = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])
PERIOD, STEPS = 1e-3, 3000


def circle(step):
    angle = 1.5e-3 * step
    return np.array([0.0, 0.05 * np.sin(angle), 0.05 * np.cos(angle) - 0.05])


def pink_times():
    import pink
    import pinocchio as pin
    from pink.tasks import FrameTask, PostureTask

    model = pin.buildModelFromUrdf(str(URDF))
    robot = pink.Configuration(model, model.createData(), HOME)
    start = robot.get_transform_frame_to_world("panda_hand_tcp").copy()
    tool = FrameTask("panda_hand_tcp", position_cost=1.0, orientation_cost=0.1, gain=0.02)
    posture = PostureTask(cost=1e-3)
    posture.set_target(HOME)
    times = []
    for step in range(STEPS):
        target = start.copy()
        target.translation = start.translation + circle(step)
        tool.set_target(target)
        begin = time.perf_counter()
        velocity = pink.solve_ik(robot, [tool, posture], PERIOD, solver="quadprog", safety_break=False)
        robot.integrate_inplace(velocity, PERIOD)
        times.append(time.perf_counter() - begin)
    return times


def mink_times():
    import mink
    import mujoco

    model = mujoco.MjModel.from_xml_string(
        URDF.read_text().replace(
            '<robot name="panda">',
            '<robot name="panda"><mujoco><compiler fusestatic="false" balanceinertia="true"/></mujoco>',
        )
    )
    robot = mink.Configuration(model)
    robot.update(HOME)
    frame = ("panda_hand_tcp", "body")
    start = robot.get_transform_frame_to_world(*frame)
    tool = mink.FrameTask(*frame, position_cost=1.0, orientation_cost=0.1, gain=0.02)
    posture = mink.PostureTask(model, cost=1e-3)
    posture.set_target(HOME)
    names = [model.joint(i).name for i in range(model.njnt)]
    limits = [
        mink.ConfigurationLimit(model),
        mink.VelocityLimit(model, {name: 2.175 for name in names}),
    ]
    times = []
    for step in range(STEPS):
        place = start.translation() + circle(step)
        tool.set_target(mink.SE3.from_rotation_and_translation(start.rotation(), place))
        begin = time.perf_counter()
        velocity = mink.solve_ik(robot, [tool, posture], PERIOD, solver="daqp", limits=limits)
        robot.integrate_inplace(velocity, PERIOD)
        times.append(time.perf_counter() - begin)
    return times


def placo_times():
    import placo

    robot = placo.RobotWrapper(str(URDF), placo.Flags.ignore_collisions)
    names = [f"panda_joint{i}" for i in range(1, 8)]
    for name, angle in zip(names, HOME):
        robot.set_joint(name, angle)
    robot.update_kinematics()
    start = robot.get_T_world_frame("panda_hand_tcp")
    solver = placo.KinematicsSolver(robot)
    solver.mask_fbase(True)
    solver.dt = PERIOD
    solver.enable_joint_limits(True)
    solver.enable_velocity_limits(True)
    tool = solver.add_frame_task("panda_hand_tcp", start)
    tool.configure("tool", "soft", 1.0, 0.1)
    posture = solver.add_joints_task()
    posture.set_joints(dict(zip(names, HOME)))
    posture.configure("posture", "soft", 1e-3)
    times = []
    for step in range(STEPS):
        target = start.copy()
        target[:3, 3] += circle(step)
        tool.T_world_frame = target
        begin = time.perf_counter()
        solver.solve(True)
        robot.update_kinematics()
        times.append(time.perf_counter() - begin)
    return times


def print_peers():
    for name, times in (("Pink", pink_times), ("mink", mink_times), ("Placo", placo_times)):
        try:
            print(f"{name:12} {1e6 * statistics.median(times()[500:]):8.1f} µs", flush=True)
        except ImportError as error:
            # Another interpreter may have it.
            print(f"{name:12} is not in {sys.prefix}: {error}", file=sys.stderr, flush=True)


def own_median():
    command = ["cargo", "bench", "-q", "-p", "whole-body", "--bench", "ik", "--", "panda"]
    text = subprocess.run(command, cwd=HERE, check=True, capture_output=True, text=True).stdout
    row = next(line for line in text.splitlines() if "panda_3_levels" in line)
    return row.split("│")[2].strip()


if __name__ == "__main__":
    print_peers()
    if "--peers" not in sys.argv:
        for interpreter in sys.argv[1:]:
            subprocess.run([interpreter, __file__, "--peers"], check=True)
        print(f"{'whole-body':12} {own_median():>11}")
