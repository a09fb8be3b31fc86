"""A robot that does exactly as it is told, with a person who stands before it: the processes of `loopback.py`."""

import gc
import math
import time
from dataclasses import dataclass
from multiprocessing import Array, Event, Process, Queue

from cyclonedds.core import ReadCondition, SampleState, ViewState, InstanceState, WaitSet
from cyclonedds.util import duration

import graph
from messages import Float64MultiArray, Header, JointState, Odometry, Point, Pose, PoseArray, String, Time

JOINTS = [f"panda_joint{joint}" for joint in range(1, 8)]
HOME = [0.0, -math.pi / 4, 0.0, -3 * math.pi / 4, 0.0, math.pi / 2, math.pi / 4]
PERIOD = 1e-3
ARM = "/forward_velocity_controller/commands"
ANY = SampleState.Any | ViewState.Any | InstanceState.Any

# A standing person, 1.75 m, who faces the robot: BODY_25 in its order, forwards and to the left [m], up [m].
BODY = [
    (0.10, 0.00, 1.60), (0.00, 0.00, 1.45), (0.00, -0.19, 1.43), (0.00, -0.22, 1.12), (0.12, -0.20, 0.90),
    (0.00, 0.19, 1.43), (0.00, 0.22, 1.12), (0.12, 0.20, 0.90), (0.00, 0.00, 0.93), (0.00, -0.10, 0.92),
    (0.00, -0.10, 0.50), (0.00, -0.10, 0.08), (0.00, 0.10, 0.92), (0.00, 0.10, 0.50), (0.00, 0.10, 0.08),
    (0.09, -0.03, 1.63), (0.09, 0.03, 1.63), (0.02, -0.08, 1.62), (0.02, 0.08, 1.62), (0.15, 0.09, 0.02),
    (0.14, 0.13, 0.02), (-0.06, 0.10, 0.03), (0.15, -0.09, 0.02), (0.14, -0.13, 0.02), (-0.06, -0.10, 0.03),
]


def joint_state(position: list, velocity: list) -> JointState:
    # Out of order, and with a gripper's joint: names count.
    return JointState(
        Header(Time.of(time.time_ns())), ["panda_finger_joint1", *reversed(JOINTS)],
        [0.0, *reversed(position)], [0.0, *reversed(velocity)], [],  # it measures no efforts
    )


def odometry(pose: list, twist: list) -> Odometry:
    message = Odometry(Header(Time.of(time.time_ns()), "odom"), "base_footprint")
    at, turned = message.pose.pose.position, message.pose.pose.orientation
    at.x, at.y = pose[0], pose[1]
    turned.z, turned.w = math.sin(pose[2] / 2), math.cos(pose[2] / 2)
    message.twist.twist.linear.x, message.twist.twist.linear.y = twist[0], twist[1]
    message.twist.twist.angular.z = twist[2]
    return message


def person() -> PoseArray:
    poses = [Pose(Point(2.0 - forwards, -left, up)) for forwards, left, up in BODY]
    poses[17].position = Point(math.nan, math.nan, math.nan)  # an ear that the camera does not see
    return PoseArray(Header(Time.of(time.time_ns()), "odom"), poses)


def matched(*endpoints) -> bool:
    return all(
        endpoint.get_matched_publications() if hasattr(endpoint, "get_matched_publications")
        else endpoint.get_matched_subscriptions()
        for endpoint in endpoints
    )


def measure(told: Array, ready: Event, stop: Event, sent: Queue) -> None:
    """Publishes what the robot measures, once a millisecond, and the person twenty times a second."""
    participant = graph.participant()
    states, base, body, action, confidences, mode = (
        graph.writer(participant, name)
        for name in ["/joint_states", "/odom", "/body_joints", "/action", "/body_confidences", "/robot_mode"]
    )
    while not (matched(states, base, body, action, confidences, mode) and ready.is_set()):
        if stop.wait(0.01):
            return
    time.sleep(1.0)  # until the other end knows all of this as well
    pose, arm, result = [0.0, 0.0, 0.0], list(HOME), Measured()
    gc.disable()  # nothing here is cyclic, and its pauses are of milliseconds
    due = written = time.monotonic()
    while not stop.is_set():
        twist, velocity = told[:3], told[3:]
        cosine, sine = math.cos(pose[2]), math.sin(pose[2])
        pose[0] += PERIOD * (cosine * twist[0] - sine * twist[1])
        pose[1] += PERIOD * (sine * twist[0] + cosine * twist[1])
        pose[2] += PERIOD * twist[2]
        arm = [angle + PERIOD * speed for angle, speed in zip(arm, velocity)]
        base.write(odometry(pose, twist))
        states.write(joint_state(arm, velocity))
        now = time.monotonic()
        written, result.longest = now, max(result.longest, now - written)
        if result.count % 50 == 0:
            action.write(String("Using The Drill"))
            mode.write(String("running"))
            seen = person()
            stamp = seen.header.stamp
            confidences.write(Float64MultiArray(data=[float(stamp.sec), float(stamp.nanosec), *[1.0] * len(BODY)]))
            body.write(seen)
        result.count += 1
        due += PERIOD
        rest = due - time.monotonic()
        if rest > 0:
            time.sleep(rest)
        elif rest < -PERIOD:
            result.late, due = result.late + 1, time.monotonic()
    result.pose = pose
    sent.put(result)


@dataclass
class Measured:
    """What was published."""

    count: int = 0
    late: int = 0  # periods that the machine did not give
    longest: float = 0.0  # from one joint state to the next [s]
    pose: list | None = None  # of the base, at the end


@dataclass
class Obeyed:
    """The commands that came, with those of the halt."""

    twists: int
    joints: int
    latency: list  # of twists, from their stamps to here [s]


def valid(samples: list) -> list:
    """Without those that only say that a publisher has gone."""
    return [sample for sample in samples if sample.sample_info.valid_data]


def obey(told: Array, ready: Event, stop: Event, obeyed: Queue) -> None:
    """Takes commands as they come."""
    participant = graph.participant()
    twists, joints = graph.reader(participant, "/cmd_vel"), graph.reader(participant, ARM)
    waits = WaitSet(participant)
    for reader in (twists, joints):
        waits.attach(ReadCondition(reader, ANY))
    while not matched(twists, joints):
        if stop.wait(0.01):
            return
    ready.set()
    gc.disable()
    result = Obeyed(0, 0, [])
    while not stop.is_set():
        waits.wait(duration(milliseconds=20))
        for sample in valid(twists.take(N=100)):
            now, linear, angular = time.time_ns(), sample.twist.linear, sample.twist.angular
            told[:3] = [linear.x, linear.y, angular.z]
            result.twists += 1
            result.latency.append(1e-9 * (now - sample.header.stamp.nanoseconds()))
        for sample in valid(joints.take(N=100)):
            told[3:] = sample.data
            result.joints += 1
    obeyed.put(result)


class Robot:
    """The robot, in two processes: one measures, one obeys."""

    def __enter__(self) -> "Robot":
        told, ready = Array("d", 10), Event()
        self.stop, self.sent, self.obeyed = Event(), Queue(), Queue()
        self.processes = [
            Process(target=measure, args=(told, ready, self.stop, self.sent)),
            Process(target=obey, args=(told, ready, self.stop, self.obeyed)),
        ]
        for process in self.processes:
            process.start()
        return self

    def results(self) -> tuple[Measured, Obeyed]:
        """Ends it."""
        self.stop.set()
        return self.sent.get(timeout=10), self.obeyed.get(timeout=10)

    def __exit__(self, *_) -> None:
        self.stop.set()
        for process in self.processes:
            process.join(timeout=10)
