# Types. What functions do, with shapes and units, is in their docstrings: help(ahqp.Solver).
from collections.abc import Sequence
from typing import Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

_Array: TypeAlias = NDArray[np.float64]
_Status: TypeAlias = Literal["solved", "iteration_limit", "time_limit"]

__all__ = [
    "Certificate",
    "Error",
    "Hierarchy",
    "InfeasibleError",
    "Limits",
    "Residuals",
    "Row",
    "Solution",
    "Solver",
    "UnfinishedError",
    "solve",
]

class Error(ValueError): ...

class InfeasibleError(Error):
    conflict: list[Row]

class UnfinishedError(Error): ...

@final
class Row:
    @property
    def kind(self) -> Literal["bound", "constraint", "objective"]: ...
    @property
    def level(self) -> int | None: ...
    @property
    def index(self) -> int: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Hierarchy:
    def __new__(cls, variables: int) -> Hierarchy: ...
    @property
    def variables(self) -> int: ...
    @property
    def names(self) -> list[str | None]: ...
    def __len__(self) -> int: ...
    @property
    def lower(self) -> _Array: ...
    @property
    def upper(self) -> _Array: ...
    def name_variables(self, names: Sequence[str]) -> None: ...
    def set_bounds(self, lower: ArrayLike | None = None, upper: ArrayLike | None = None) -> None: ...
    def push(
        self,
        A: ArrayLike,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        *,
        hard: bool = False,
        weights: ArrayLike | None = None,
        name: str | None = None,
    ) -> int: ...
    def push_quadratic(self, H: ArrayLike, g: ArrayLike, *, name: str | None = None) -> int: ...
    def update(
        self,
        level: int,
        *,
        A: ArrayLike | None = None,
        lower: ArrayLike | None = None,
        upper: ArrayLike | None = None,
        weights: ArrayLike | None = None,
    ) -> None: ...
    def update_quadratic(
        self, level: int, *, H: ArrayLike | None = None, g: ArrayLike | None = None
    ) -> None: ...
    def __copy__(self) -> Hierarchy: ...

@final
class Solver:
    def __new__(
        cls,
        hierarchy: Hierarchy,
        *,
        max_iterations: int = 1000,
        feasibility_tolerance: float = 1e-10,
        rank_tolerance: float = 1e-10,
        optimality_tolerance: float = 1e-10,
        warm_start: bool = True,
    ) -> Solver: ...
    def solve(
        self, hierarchy: Hierarchy, *, iterations: int | None = None, time: float | None = None
    ) -> Solution: ...
    def conflict(self, hierarchy: Hierarchy) -> list[Row]: ...
    def certificate(self, hierarchy: Hierarchy) -> Certificate: ...
    def forget(self) -> None: ...
    def __copy__(self) -> Solver: ...

@final
class Solution:
    @property
    def x(self) -> _Array: ...
    @property
    def best(self) -> _Array: ...
    @property
    def status(self) -> _Status: ...
    @property
    def iterations(self) -> int: ...
    @property
    def time(self) -> float: ...
    @property
    def violations(self) -> _Array: ...
    @property
    def multipliers(self) -> list[list[tuple[Row, float]]]: ...

@final
class Certificate:
    def multipliers(self, level: int) -> list[tuple[Row, float]]: ...
    @property
    def active(self) -> list[Row]: ...
    def residuals(self, hierarchy: Hierarchy, x: ArrayLike) -> Residuals: ...

@final
class Residuals:
    @property
    def stationarity(self) -> float: ...
    @property
    def feasibility(self) -> float: ...
    @property
    def complementarity(self) -> float: ...
    @property
    def sign(self) -> float: ...
    @property
    def distance(self) -> float | None: ...
    @property
    def worst(self) -> float: ...

@final
class Limits:
    def __new__(
        cls,
        lower: ArrayLike,
        upper: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike,
        jerk: ArrayLike | None = None,
    ) -> Limits: ...
    def velocity_interval(
        self,
        position: ArrayLike,
        velocity: ArrayLike,
        period: float,
        acceleration: ArrayLike | None = None,
    ) -> tuple[_Array, _Array]: ...
    def admits(
        self, position: ArrayLike, velocity: ArrayLike, acceleration: ArrayLike | None = None
    ) -> list[bool]: ...
    def __len__(self) -> int: ...

def solve(
    A: ArrayLike,
    lower: ArrayLike,
    upper: ArrayLike,
    breaks: ArrayLike,
    lb: ArrayLike | None = None,
    ub: ArrayLike | None = None,
) -> Solution: ...
