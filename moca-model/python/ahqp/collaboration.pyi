# Types. What functions do, with shapes and units, is in their docstrings: help(ahqp.collaboration.Controller).
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, ClassVar, Literal, TypeAlias, TypedDict, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import Error
from .ergo import ErgonomicsMap, Person, Quadratic
from .whole_body import Model

_Array: TypeAlias = NDArray[np.float64]
_Compensation: TypeAlias = Literal["nothing", "franka"]
_Settings: TypeAlias = Mapping[str, Any] | str | PathLike[str]
_Recognised: TypeAlias = str | tuple[str, float]
_Phase: TypeAlias = Literal["apart", "looking", "handover", "grasping", "turning", "working", "walking"]
_Safety: TypeAlias = Literal["normal", "reduced", "retreat", "protective_stop"]
_Side: TypeAlias = Literal["left", "right"]

__all__ = [
    "Body",
    "Command",
    "Controller",
    "FrameError",
    "GraspedObject",
    "MOCA_URDF",
    "Recording",
    "Scene",
]

MOCA_URDF: str

class FrameError(Error): ...

class _Tracked(TypedDict):
    floor: _Array
    heading: float
    velocity: _Array
    age: float

@final
class Body:
    JOINTS: ClassVar[list[str]]
    def __new__(
        cls,
        joints: ArrayLike | Mapping[str, ArrayLike],
        confidences: ArrayLike | None = None,
        *,
        covariances: ArrayLike | None = None,
        id: int | None = None,
    ) -> Body: ...
    @staticmethod
    def standing(
        person: Person,
        floor: ArrayLike,
        heading: float,
        *,
        hand: ArrayLike | None = None,
        side: _Side = "right",
        id: int | None = None,
    ) -> Body: ...
    @property
    def seen(self) -> list[str]: ...
    @property
    def joints(self) -> _Array: ...
    @property
    def confidences(self) -> _Array: ...
    @property
    def covariances(self) -> _Array: ...
    @property
    def id(self) -> int | None: ...

@final
class Scene:
    ACTIONS: ClassVar[list[str]]
    def __new__(
        cls,
        body: Body | None = None,
        *,
        time: float | None = None,
        action: _Recognised | None = None,
        surface: _Recognised | None = None,
        others: Sequence[Body] = ...,
    ) -> Scene: ...
    @property
    def time(self) -> float | None: ...
    @property
    def body(self) -> Body | None: ...
    @property
    def action(self) -> tuple[str, float] | None: ...
    @property
    def surface(self) -> tuple[str, float] | None: ...
    @property
    def others(self) -> list[Body]: ...

@final
class GraspedObject:
    def __new__(
        cls,
        *,
        size: ArrayLike | None = None,
        mass: float | None = None,
        pose: ArrayLike | None = None,
        faces: Mapping[str, str] | None = None,
    ) -> GraspedObject: ...
    @property
    def size(self) -> _Array: ...
    @property
    def mass(self) -> float: ...
    @property
    def pose(self) -> _Array: ...
    @property
    def faces(self) -> dict[str, str]: ...

@final
class Command:
    @property
    def velocity(self) -> _Array: ...
    @property
    def position(self) -> _Array: ...
    @property
    def torque(self) -> _Array | None: ...
    @property
    def base_twist(self) -> _Array: ...
    @property
    def base_drives(self) -> bool: ...
    @property
    def desired(self) -> _Array: ...
    @property
    def desired_twist(self) -> _Array: ...
    @property
    def slack(self) -> _Array: ...
    @property
    def phase(self) -> _Phase: ...
    @property
    def together(self) -> bool: ...
    @property
    def activation(self) -> float: ...
    @property
    def safety(self) -> _Safety: ...
    @property
    def cause(self) -> str | None: ...
    @property
    def fault(self) -> str | None: ...
    @property
    def waits_for(self) -> str | None: ...
    @property
    def is_optimal(self) -> bool: ...
    @property
    def duration(self) -> float: ...

@final
class Controller:
    def __new__(
        cls,
        model: Model,
        start: ArrayLike,
        tool: str,
        person: Person | ErgonomicsMap | None = None,
        *,
        bodies: Sequence[tuple[str, ArrayLike, ArrayLike, float]] = ...,
        own_pairs: Sequence[tuple[str, str]] = ...,
        mecanum: tuple[float, float, float] | None = None,
        compensation: _Compensation | None = None,
        settings: _Settings | None = None,
    ) -> Controller: ...
    @staticmethod
    def moca(
        person: Person | ErgonomicsMap | None = None,
        *,
        start: ArrayLike | None = None,
        compensation: _Compensation | None = None,
        settings: _Settings | None = None,
    ) -> Controller: ...
    def observe(self, scene: Scene, *, now: float | None = None) -> None: ...
    def step(
        self,
        q: ArrayLike,
        dt: float | None = None,
        *,
        velocity: ArrayLike | None = None,
        torque: ArrayLike | None = None,
        age: float = 0.0,
    ) -> Command: ...
    def acknowledge(self) -> None: ...
    def request_stop(self) -> None: ...
    def robot_stopped(self) -> None: ...
    def set_external_force(self, force: float) -> None: ...
    def grasp(self, object: GraspedObject) -> None: ...
    def release(self) -> GraspedObject | None: ...
    def set_goal(self, goal: Literal["ergonomics", "least_motion"]) -> None: ...
    def set_ergonomics(self, ergonomics: Quadratic) -> None: ...
    @property
    def model(self) -> Model: ...
    @property
    def position(self) -> _Array: ...
    @property
    def time(self) -> float: ...
    @property
    def hand(self) -> _Array: ...
    @property
    def person(self) -> _Tracked | None: ...
    @property
    def room(self) -> float | None: ...
    @property
    def external_force(self) -> _Array | None: ...
    @property
    def settings(self) -> dict[str, dict[str, Any]]: ...

@final
class Recording:
    def __new__(
        cls, scenes: Sequence[Scene], *, stature: float | None = None, rate: float = 20.0
    ) -> Recording: ...
    @staticmethod
    def read(path: str | PathLike[str], *, partial: bool = False) -> Recording: ...
    def write(self, path: str | PathLike[str]) -> None: ...
    @property
    def scenes(self) -> list[Scene]: ...
    @property
    def stature(self) -> float | None: ...
    @property
    def rate(self) -> float: ...
    @property
    def is_complete(self) -> bool: ...
