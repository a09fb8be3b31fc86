"""Robots."""

import ast

import numpy as np
import pytest
from support import PANDA, run_example, run_rust_example

import ahqp
from ahqp.whole_body import (
    AxisTask,
    CentreOfMassTask,
    DampingTask,
    Data,
    FrameTask,
    FrameVelocityLimit,
    Ik,
    JointCouplingTask,
    Model,
    OrientationTask,
    PositionTask,
    PostureTask,
    RelativeFrameTask,
    SelfCollisionLimit,
    VelocityTask,
    WheelLimit,
)

TOOL = "panda_hand_tcp"
START = np.array([0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785])


def panda(**options):
    return Model.from_file(PANDA, **options)


def test_the_circle_is_bit_for_bit_that_of_rust():
    assert ast.literal_eval(run_example("panda_circle")) == ast.literal_eval(run_rust_example("panda_circle"))


def test_jacobians_are_differences_of_poses():
    model, step = panda(), 1e-6
    data = Data(model)
    data.update(START, np.ones(7))
    jacobian, twist = data.jacobian(TOOL), data.twist(TOOL)
    assert jacobian @ np.ones(7) == pytest.approx(twist, abs=1e-12)
    pose = data.pose(TOOL)
    for joint in range(7):
        moved = START.copy()
        moved[joint] += step
        data.update(moved)
        difference = (data.pose(TOOL)[:3, 3] - pose[:3, 3]) / step
        assert jacobian[:3, joint] == pytest.approx(difference, abs=1e-5)
    data.update(START)
    local = data.jacobian(TOOL, local=True)
    assert pose[:3, :3] @ local[:3] == pytest.approx(jacobian[:3], abs=1e-12)


def test_dynamics_agree_with_each_other():
    model = panda()
    data, rng = Data(model), np.random.default_rng(1)
    v, acceleration = rng.normal(size=7), rng.normal(size=7)
    data.update(START, v)
    mass, bias = data.mass_matrix(), data.bias_forces()
    torque = data.inverse_dynamics(acceleration)
    assert torque == pytest.approx(mass @ acceleration + bias, abs=1e-9)
    assert data.forward_dynamics(torque) == pytest.approx(acceleration, abs=1e-9)
    assert data.kinetic_energy() == pytest.approx(0.5 * v @ mass @ v, abs=1e-12)
    # Gravity is the slope of the potential energy.
    gravity, energy = data.gravity(), data.potential_energy()
    data.update(START + 1e-6 * np.eye(7)[1])
    assert (data.potential_energy() - energy) / 1e-6 == pytest.approx(gravity[1], abs=1e-3)
    centre = data.centre_of_mass_jacobian()
    assert centre.shape == (3, 7) and data.centre_of_mass().shape == (3,)
    assert data.jacobian_rate_times_velocity.__doc__ and model.mass > 0.0


def test_a_velocity_is_needed_for_what_moves():
    data = Data(panda())
    data.update(START)
    with pytest.raises(ValueError, match="no velocity"):
        data.twist(TOOL)


def test_all_tasks_reach_their_targets_within_the_limits():
    model = panda()
    limits = model.limits
    tasks = {
        "pose": {"place": PositionTask(TOOL), "turn": OrientationTask(TOOL)},
        "rest": {"posture": PostureTask(gain=1.0), "damping": DampingTask(weights=np.full(7, 1e-3))},
    }
    ik = Ik(model, tasks, START, limits={"tool": FrameVelocityLimit(TOOL, [0.2] * 3, [np.inf] * 3)})
    goal = ik.pose(START, TOOL)[:3, 3] + [0.05, 0.1, -0.1]
    ik.set_target("place", goal)
    q, last = START, np.zeros(7)
    for _ in range(3000):
        step = ik.step(q, 1e-3)
        assert step.status == "solved"
        assert np.all(np.abs(step.velocity) <= limits["velocity"] * (1 + 1e-9))
        assert np.all(np.abs(step.velocity - last) <= limits["acceleration"] * 1e-3 * (1 + 1e-6))
        last, q = step.velocity, step.q
    assert ik.pose(q, TOOL)[:3, 3] == pytest.approx(goal, abs=1e-6)
    assert set(step.slack) == {"place", "turn", "posture", "damping"}
    assert step.iterations > 0 and step.acceleration.shape == (7,)


def test_every_kind_of_task_takes_a_target():
    model = panda(frames={"tool": (TOOL, np.eye(4))})
    tasks = {
        "frame": FrameTask("tool", gain=10.0),
        "relative": RelativeFrameTask("panda_link2", TOOL),
        "axis": AxisTask(TOOL, [0.0, 0.0, 1.0]),
        "mass": CentreOfMassTask(axes="x"),
        "coupling": JointCouplingTask({"panda_joint1": 1.0, "panda_joint3": -1.0}),
        "posture": PostureTask(["panda_joint5"]),
    }
    ik = Ik(model, tasks, START, iterations=500)
    pose = ik.pose(START, "tool")
    ik.set_target("frame", pose, velocity=np.zeros(6))
    ik.set_target("relative", np.eye(4))
    ik.set_target("axis", [0.0, 0.0, -2.0])
    ik.set_target("mass", [0.1, 0.0, 0.3], velocity=[0.0, 0.0, 0.0])
    ik.set_target("coupling", 0.1)
    ik.set_target("posture", START)
    with pytest.raises(ValueError, match="cannot move"):
        ik.set_target("axis", [0.0, 0.0, 1.0], velocity=[0.0, 0.0, 0.0])
    assert ik.step(START, 1e-3).slack["frame"] < 1e-6
    joint, limit, end = ik.step(START, 1e-3).active_limits[0]
    assert joint in model.joints and limit in {"position", "velocity", "acceleration"}
    assert end in {"lower", "upper"}


def test_bases_move_and_brake():
    slow = {"velocity": 1.0, "acceleration": 1.0}
    names = ("base_x", "base_y", "base_yaw")
    model = panda(base="planar", limits=dict.fromkeys(names, slow))
    assert model.joints[:3] == list(names)
    q = model.neutral()
    ik = Ik(model, {"tool": PositionTask(TOOL), "rest": PostureTask()}, q, limits={"wheels": WheelLimit.mecanum(1.0, 0.4)})
    ik.set_target("tool", [2.0, 0.0, 0.8])
    for _ in range(300):
        q = ik.step(q, 1e-3).q
    assert q[0] > 0.0
    velocity = ik.brake(1e-3)
    for _ in range(3000):
        velocity = ik.brake(1e-3)
    assert np.abs(velocity).max() < 1e-12
    ik.reset(np.zeros(10))
    ik.hold(q)
    floating = panda(base="floating")
    assert floating.position_count == floating.velocity_count + 1
    q = floating.integrate(floating.neutral(), np.full(13, 0.1))
    assert floating.difference(floating.neutral(), q) == pytest.approx(np.full(13, 0.1), abs=1e-12)


def test_rows_of_ones_own_hold_as_task_and_limit():
    model = panda()
    data = Data(model)
    data.update(START)
    height = data.jacobian(TOOL)[2]
    tasks = {"sum": VelocityTask(1), "tool": PositionTask(TOOL), "rest": DampingTask()}
    ik = Ik(model, tasks, START, limits={"floor": VelocityTask(2)})
    ik.set_target("tool", ik.pose(START, TOOL)[:3, 3] - [0.0, 0.0, 0.3])
    ik.set_rows("sum", [[1.0, 1.0, 0, 0, 0, 0, 0]], [0.02], [0.02])
    free = [ik.step(START, 1e-3).velocity for _ in range(100)][-1]
    assert free[0] + free[1] == pytest.approx(0.02, abs=1e-9) and height @ free < -0.1
    # The tool may not sink faster than 0.05 m/s.
    ik.set_rows("floor", [height, np.zeros(7)], [-0.05, -np.inf], [np.inf, np.inf])
    slow = [ik.step(START, 1e-3).velocity for _ in range(200)][-1]
    assert height @ slow == pytest.approx(-0.05, abs=1e-9)
    with pytest.raises(ValueError, match="no VelocityTask"):
        ik.set_rows("tool", [height], [0.0], [0.0])
    with pytest.raises(ValueError, match="set_rows writes them"):
        ik.set_target("sum", [0.0])
    with pytest.raises(ValueError, match="A has 1 rows; it must have 2"):
        ik.set_rows("floor", [height], [0.0, 0.0], [0.0, 0.0])
    with pytest.raises(ValueError, match="rows is 0"):
        VelocityTask(0)


def test_tasks_are_switched_off_and_on():
    ik = Ik(panda(), {"tool": PositionTask(TOOL), "posture": PostureTask()}, START)
    goal = ik.pose(START, TOOL)[:3, 3] + [0.0, 0.1, 0.0]
    ik.set_target("tool", goal)
    ik.set_weights("tool", np.zeros(3))
    q = START
    for _ in range(200):
        q = ik.step(q, 1e-3).q
    assert q == pytest.approx(START, abs=1e-9)
    ik.set_weights("tool", np.ones(3))
    for _ in range(3000):
        q = ik.step(q, 1e-3).q
    assert ik.pose(q, TOOL)[:3, 3] == pytest.approx(goal, abs=1e-6)
    ik.set_weights("posture", np.arange(7.0))
    for wrong, message in [(np.ones(2), "2 entries"), (-np.ones(3), "a weight is -1"), (np.full(3, np.nan), "NaN")]:
        with pytest.raises(ValueError, match=message):
            ik.set_weights("tool", wrong)


def test_joints_stand_where_they_are_asked_to():
    model = panda()
    ik = Ik(model, {"tool": PositionTask(TOOL), "rest": DampingTask()}, START)
    ik.set_target("tool", ik.pose(START, TOOL)[:3, 3] + [0.0, 0.2, 0.0])
    q = START
    for _ in range(100):
        q = ik.step(q, 1e-3).q
    moving = ik.step(q, 1e-3).velocity[0]
    velocities = [ik.step(q, 1e-3, within={"panda_joint1": (0.0, 0.0)}).velocity[0] for _ in range(200)]
    # The joint brakes within its limit, and then stands.
    assert abs(moving) > 0.05 and velocities[-1] == 0.0
    assert np.abs(np.diff([moving, *velocities])).max() <= model.limits["acceleration"][0] * 1e-3 * (1 + 1e-6)
    with pytest.raises(ValueError, match="the lower one first"):
        ik.step(q, 1e-3, within={"panda_joint1": (1.0, 0.0)})
    with pytest.raises(ahqp.Error, match="elbow"):
        ik.step(q, 1e-3, within={"elbow": (0.0, 0.0)})


def test_the_hand_stays_away_from_the_base():
    model = panda()
    at, size = np.array([0.0, 0.0, 0.15]), np.array([0.12, 0.08])
    bodies = [("panda_link0", at, at, size[0]), ("panda_hand", [0.0] * 3, [0.0] * 3, size[1])]
    pairs = [("panda_link0", "panda_hand")]

    def least(limits):
        """The least distance of the two spheres while the hand is drawn into the base."""
        ik = Ik(model, {"hand": PositionTask("panda_hand")}, START, limits=limits)
        ik.set_target("hand", at)
        q, nearest = START, np.inf
        for _ in range(2000):
            q = ik.step(q, 2e-3).q
            nearest = min(nearest, np.linalg.norm(ik.pose(q, "panda_hand")[:3, 3] - at) - size.sum())
        return nearest

    assert least(None) < 0.0
    assert 0.029 < least({"own": SelfCollisionLimit(bodies, pairs)}) < 0.04
    assert 0.099 < least({"own": SelfCollisionLimit(bodies, pairs, distance=0.1)}) < 0.11
    with pytest.raises(ahqp.Error, match="no capsule is on link `panda_link5`"):
        Ik(model, {"hand": PositionTask("panda_hand")}, START, limits={"own": SelfCollisionLimit(bodies, [("panda_link0", "panda_link5")])})
