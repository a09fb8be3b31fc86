"""Any robot by its URDF: kinematics, dynamics, and inverse kinematics with strict priorities."""

from ._ahqp import (
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
    Step,
    VelocityTask,
    WheelLimit,
)

__all__ = [
    "AxisTask",
    "CentreOfMassTask",
    "DampingTask",
    "Data",
    "FrameTask",
    "FrameVelocityLimit",
    "Ik",
    "JointCouplingTask",
    "Model",
    "OrientationTask",
    "PositionTask",
    "PostureTask",
    "RelativeFrameTask",
    "Step",
    "VelocityTask",
    "WheelLimit",
]
