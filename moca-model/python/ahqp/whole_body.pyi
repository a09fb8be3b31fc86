# Types. What functions do, with shapes and units, is in their docstrings: help(ahqp.whole_body.Ik).
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array: TypeAlias = NDArray[np.float64]
_Status: TypeAlias = Literal["solved", "iteration_limit", "time_limit"]
_Base: TypeAlias = Literal["fixed", "planar", "floating"]
_Task: TypeAlias = (
    PositionTask
    | OrientationTask
    | CentreOfMassTask
    | FrameTask
    | RelativeFrameTask
    | AxisTask
    | PostureTask
    | DampingTask
    | JointCouplingTask
    | VelocityTask
)
_Limit: TypeAlias = WheelLimit | FrameVelocityLimit | SelfCollisionLimit | VelocityTask

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
    "SelfCollisionLimit",
    "Step",
    "VelocityTask",
    "WheelLimit",
]

@final
class Model:
    def __new__(
        cls,
        urdf: str,
        *,
        base: _Base = "fixed",
        root: str | None = None,
        tips: Sequence[str] = ...,
        joints: Sequence[str] = ...,
        locked: Mapping[str, float] | None = None,
        origins: Mapping[str, ArrayLike] | None = None,
        limits: Mapping[str, Mapping[str, float | tuple[float, float]]] | None = None,
        frames: Mapping[str, tuple[str, ArrayLike]] | None = None,
        gravity: ArrayLike | None = None,
        time_to_full_speed: float | None = None,
        ignore_unusable_limits: bool = False,
    ) -> Model: ...
    @staticmethod
    def from_file(
        path: str | PathLike[str],
        *,
        base: _Base = "fixed",
        root: str | None = None,
        tips: Sequence[str] = ...,
        joints: Sequence[str] = ...,
        locked: Mapping[str, float] | None = None,
        origins: Mapping[str, ArrayLike] | None = None,
        limits: Mapping[str, Mapping[str, float | tuple[float, float]]] | None = None,
        frames: Mapping[str, tuple[str, ArrayLike]] | None = None,
        gravity: ArrayLike | None = None,
        time_to_full_speed: float | None = None,
        ignore_unusable_limits: bool = False,
    ) -> Model: ...
    @property
    def name(self) -> str: ...
    @property
    def position_count(self) -> int: ...
    @property
    def velocity_count(self) -> int: ...
    @property
    def joints(self) -> list[str]: ...
    @property
    def frames(self) -> list[str]: ...
    @property
    def limits(self) -> dict[str, _Array]: ...
    @property
    def mass(self) -> float: ...
    @property
    def warnings(self) -> list[str]: ...
    def neutral(self) -> _Array: ...
    def integrate(self, q: ArrayLike, displacement: ArrayLike) -> _Array: ...
    def difference(self, start: ArrayLike, end: ArrayLike) -> _Array: ...

@final
class Data:
    def __new__(cls, model: Model) -> Data: ...
    def update(self, q: ArrayLike, v: ArrayLike | None = None) -> None: ...
    def pose(self, frame: str) -> _Array: ...
    def jacobian(self, frame: str, *, local: bool = False) -> _Array: ...
    def jacobian_rate_times_velocity(self, frame: str, *, local: bool = False) -> _Array: ...
    def twist(self, frame: str, *, local: bool = False) -> _Array: ...
    def centre_of_mass(self) -> _Array: ...
    def centre_of_mass_jacobian(self) -> _Array: ...
    def gravity(self) -> _Array: ...
    def mass_matrix(self) -> _Array: ...
    def bias_forces(self) -> _Array: ...
    def inverse_dynamics(self, acceleration: ArrayLike) -> _Array: ...
    def forward_dynamics(self, torque: ArrayLike) -> _Array: ...
    def kinetic_energy(self) -> float: ...
    def potential_energy(self) -> float: ...

@final
class PositionTask:
    def __new__(
        cls,
        frame: str,
        *,
        gain: float | None = None,
        deceleration: float | None = None,
        axes: str = "xyz",
        weights: ArrayLike | None = None,
    ) -> PositionTask: ...

@final
class OrientationTask:
    def __new__(
        cls,
        frame: str,
        *,
        gain: float | None = None,
        deceleration: float | None = None,
        axes: str = "xyz",
        weights: ArrayLike | None = None,
    ) -> OrientationTask: ...

@final
class CentreOfMassTask:
    def __new__(
        cls,
        *,
        gain: float | None = None,
        deceleration: float | None = None,
        axes: str = "xyz",
        weights: ArrayLike | None = None,
    ) -> CentreOfMassTask: ...

@final
class FrameTask:
    def __new__(
        cls, frame: str, *, gain: float | None = None, weights: ArrayLike | None = None
    ) -> FrameTask: ...

@final
class RelativeFrameTask:
    def __new__(
        cls,
        reference: str,
        frame: str,
        *,
        gain: float | None = None,
        weights: ArrayLike | None = None,
    ) -> RelativeFrameTask: ...

@final
class AxisTask:
    def __new__(
        cls,
        frame: str,
        axis: ArrayLike,
        *,
        gain: float | None = None,
        deceleration: float | None = None,
        weight: float = 1.0,
    ) -> AxisTask: ...

@final
class PostureTask:
    def __new__(
        cls,
        joints: Sequence[str] | None = None,
        *,
        gain: float | None = None,
        deceleration: float | None = None,
        weights: ArrayLike | None = None,
    ) -> PostureTask: ...

@final
class DampingTask:
    def __new__(cls, *, weights: ArrayLike | None = None) -> DampingTask: ...

@final
class JointCouplingTask:
    def __new__(cls, joints: Mapping[str, float], *, weight: float = 1.0) -> JointCouplingTask: ...

@final
class VelocityTask:
    def __new__(cls, rows: int, *, weights: ArrayLike | None = None) -> VelocityTask: ...

@final
class WheelLimit:
    @staticmethod
    def mecanum(speed: float, lever: float) -> WheelLimit: ...
    @staticmethod
    def omni(speed: float, radius: float, angles: ArrayLike) -> WheelLimit: ...
    @staticmethod
    def differential(speed: float, track: float) -> WheelLimit: ...

@final
class FrameVelocityLimit:
    def __new__(
        cls, frame: str, linear: ArrayLike, angular: ArrayLike, *, local: bool = False
    ) -> FrameVelocityLimit: ...

@final
class SelfCollisionLimit:
    def __new__(
        cls,
        bodies: Sequence[tuple[str, ArrayLike, ArrayLike, float]],
        pairs: Sequence[tuple[str, str]],
        *,
        distance: float = 0.03,
    ) -> SelfCollisionLimit: ...

@final
class Ik:
    def __new__(
        cls,
        model: Model,
        tasks: Mapping[str, _Task | Mapping[str, _Task]],
        hold: ArrayLike | None = None,
        *,
        limits: Mapping[str, _Limit] | None = None,
        singularity_threshold: float = 0.1,
        iterations: int | None = None,
    ) -> Ik: ...
    def set_target(
        self, task: str, target: ArrayLike, velocity: ArrayLike | None = None
    ) -> None: ...
    def set_rows(self, task: str, A: ArrayLike, lower: ArrayLike, upper: ArrayLike) -> None: ...
    def set_weights(self, task: str, weights: ArrayLike) -> None: ...
    def step(
        self,
        q: ArrayLike,
        period: float,
        within: Mapping[str, tuple[float, float]] | None = None,
    ) -> Step: ...
    def brake(self, period: float) -> _Array: ...
    def reset(self, velocity: ArrayLike) -> None: ...
    def hold(self, q: ArrayLike) -> None: ...
    def pose(self, q: ArrayLike, frame: str) -> _Array: ...

@final
class Step:
    @property
    def velocity(self) -> _Array: ...
    @property
    def acceleration(self) -> _Array: ...
    @property
    def q(self) -> _Array: ...
    @property
    def slack(self) -> dict[str, float]: ...
    @property
    def active_limits(self) -> list[tuple[str, str, Literal["lower", "upper"]]]: ...
    @property
    def status(self) -> _Status: ...
    @property
    def iterations(self) -> int: ...
