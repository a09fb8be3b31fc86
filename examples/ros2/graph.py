"""The robot's end of the ROS graph in Cyclone DDS: topics by their ROS names, with the QoS of ROS nodes."""

import os

from cyclonedds.core import Policy, Qos
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from messages import CameraInfo, Float64MultiArray, Image, JointState, Odometry, PoseArray, String, TFMessage, TwistStamped

# What publishers and subscribers of ROS have by default, and what ros2_controllers have.
RELIABLE = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.Volatile,
    Policy.History.KeepLast(100),
)

# What static_transform_publisher has: whoever comes later receives the last message.
LATCHED = Qos(
    Policy.Reliability.Reliable(duration(milliseconds=100)),
    Policy.Durability.TransientLocal,
    Policy.History.KeepLast(1),
)

TYPES = {
    "/joint_states": JointState,
    "/odom": Odometry,
    "/robot_mode": String,
    "/tf": TFMessage,
    "/tf_static": TFMessage,
    "/body_confidences": Float64MultiArray,
    "/body_covariances": Float64MultiArray,
    "/body_joints": PoseArray,
    "/people": Float64MultiArray,
    "/perception_delays": Float64MultiArray,
    "/action": String,
    "/surface": String,
    "/camera/camera/color/image_raw": Image,
    "/camera/camera/aligned_depth_to_color/image_raw": Image,
    "/camera/camera/color/camera_info": CameraInfo,
    "/cmd_vel": TwistStamped,
    "/forward_effort_controller/commands": Float64MultiArray,
    "/forward_velocity_controller/commands": Float64MultiArray,
    "/forward_position_controller/commands": Float64MultiArray,
}


def participant() -> DomainParticipant:
    """One in the domain of ROS_DOMAIN_ID, or 0."""
    return DomainParticipant(int(os.environ.get("ROS_DOMAIN_ID") or 0))


def writer(participant: DomainParticipant, name: str, message: type | None = None, qos: Qos = RELIABLE) -> DataWriter:
    return DataWriter(participant, Topic(participant, f"rt{name}", message or TYPES[name]), qos)


def reader(participant: DomainParticipant, name: str) -> DataReader:
    return DataReader(participant, Topic(participant, f"rt{name}", TYPES[name]), RELIABLE)
