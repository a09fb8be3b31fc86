# Types. What functions do, with shapes and units, is in their docstrings: help(ahqp.vision.Lifter).
from collections.abc import Callable, Iterable, Mapping, Sequence
from os import PathLike
from typing import ClassVar, Literal, TypeAlias, final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .collaboration import Body

_Array: TypeAlias = NDArray[np.float64]
_Floats: TypeAlias = NDArray[np.float32]
_Path: TypeAlias = str | PathLike[str]
_File: TypeAlias = _Path | bytes
_Weights: TypeAlias = _Path | Mapping[str, ArrayLike]

__all__ = [
    "BlazePose",
    "Camera",
    "CameraPlacement",
    "FollowedPerson",
    "ImageBody",
    "Landmarks",
    "Lifter",
    "LinearSvm",
    "MonocularLifter",
    "OpenPose",
    "People",
    "Preprocessing",
    "ResNet",
    "Scores",
    "SimpleBaseline",
    "SlowOnly",
    "SlowOnlyStream",
    "TensorFlowLite",
    "Training",
    "Triangulator",
    "nearest_person",
    "read_depth",
    "read_image",
    "read_weights",
]

@final
class Scores:
    @property
    def logits(self) -> _Floats: ...
    @property
    def features(self) -> _Floats: ...
    @property
    def probabilities(self) -> _Floats: ...

@final
class ResNet:
    def __new__(
        cls, weights: _Weights, *, height: int = 224, width: int = 224, threads: int = 1
    ) -> ResNet: ...
    def infer(self, images: ArrayLike) -> Scores: ...
    @property
    def classes(self) -> int: ...
    @property
    def operations(self) -> int: ...

@final
class SlowOnly:
    def __new__(
        cls, weights: _Weights, *, frames: int = 8, height: int = 256, width: int = 256, threads: int = 1
    ) -> SlowOnly: ...
    def infer(self, clips: ArrayLike) -> Scores: ...
    @property
    def classes(self) -> int: ...
    @property
    def operations(self) -> int: ...

@final
class SlowOnlyStream:
    def __new__(
        cls, weights: _Weights, *, frames: int = 8, height: int = 256, width: int = 256, threads: int = 1
    ) -> SlowOnlyStream: ...
    def push(self, frame: ArrayLike) -> Scores | None: ...
    def add(self, frame: ArrayLike) -> None: ...
    def clear(self) -> None: ...

@final
class TensorFlowLite:
    def __new__(
        cls, file: _File, *, outputs: Sequence[int] | None = None, threads: int = 1
    ) -> TensorFlowLite: ...
    def infer(self, images: ArrayLike) -> list[_Floats]: ...
    @property
    def input(self) -> tuple[int, int, int]: ...
    @property
    def outputs(self) -> list[tuple[int, int, int]]: ...
    @property
    def operations(self) -> int: ...

@final
class Training:
    @property
    def converged(self) -> bool: ...
    @property
    def iterations(self) -> int: ...
    @property
    def objective(self) -> float: ...
    @property
    def gap(self) -> float: ...

@final
class LinearSvm:
    def __new__(cls, classes: Sequence[str], weights: ArrayLike, biases: ArrayLike) -> LinearSvm: ...
    @staticmethod
    def train(
        samples: ArrayLike,
        labels: ArrayLike,
        classes: Sequence[str],
        *,
        loss: Literal["squared_hinge", "hinge"] = "squared_hinge",
        cost: float = 1.0,
        bias_scaling: float | None = None,
        class_weights: Literal["balanced"] | ArrayLike | None = None,
        tolerance: float = 1e-9,
        max_iterations: int = 2000,
    ) -> tuple[LinearSvm, list[Training]]: ...
    @staticmethod
    def load(path: _Path) -> LinearSvm: ...
    def save(self, path: _Path) -> None: ...
    def classify(self, samples: ArrayLike) -> NDArray[np.uintp]: ...
    def decide(self, samples: ArrayLike) -> _Array: ...
    @property
    def classes(self) -> list[str]: ...
    @property
    def weights(self) -> _Array: ...
    @property
    def biases(self) -> _Array: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class Preprocessing:
    TORCHVISION: ClassVar[Preprocessing]
    SURFACE: ClassVar[Preprocessing]
    MMACTION2: ClassVar[Preprocessing]
    PYTORCHVIDEO: ClassVar[Preprocessing]
    def __new__(
        cls,
        library: Literal["torchvision", "mmaction2", "pytorchvideo"] = "torchvision",
        *,
        short_side: int | None = None,
        square: int | None = None,
        crop: int = 224,
        crops: Literal["centre", "three", "ten"] = "centre",
    ) -> Preprocessing: ...
    def image(self, frame: NDArray[np.uint8]) -> _Floats: ...
    def clip(self, frames: NDArray[np.uint8] | Iterable[NDArray[np.uint8]]) -> _Floats: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    __hash__: None  # type: ignore[assignment]

@final
class ImageBody:
    LAYOUTS: ClassVar[dict[str, int]]
    def __new__(
        cls,
        joints: ArrayLike,
        confidences: ArrayLike | None = None,
        *,
        metric: ArrayLike | None = None,
        layout: str = "BODY_25",
    ) -> ImageBody: ...
    @property
    def seen(self) -> list[str]: ...
    @property
    def joints(self) -> _Array: ...
    @property
    def confidences(self) -> _Array: ...
    @property
    def metric(self) -> _Array | None: ...

@final
class Landmarks:
    @property
    def positions(self) -> _Array: ...
    @property
    def depths(self) -> _Array: ...
    @property
    def metric(self) -> _Array: ...
    @property
    def visibility(self) -> _Array: ...
    @property
    def presence(self) -> _Array: ...
    @property
    def score(self) -> float: ...
    @property
    def body(self) -> ImageBody: ...

@final
class BlazePose:
    def __new__(
        cls,
        detector: _File,
        landmarks: _File,
        *,
        most: int = 1,
        detection: float = 0.5,
        presence: float = 0.5,
        threads: int = 1,
    ) -> BlazePose: ...
    def estimate(self, image: NDArray[np.uint8], time: float) -> list[Landmarks]: ...
    def forget(self) -> None: ...

@final
class SimpleBaseline:
    def __new__(cls, weights: _Weights, *, mirrored: bool = False, threads: int = 1) -> SimpleBaseline: ...
    def estimate(self, image: NDArray[np.uint8], box: ArrayLike) -> ImageBody: ...

@final
class OpenPose:
    def __new__(
        cls, weights: _Weights, *, height: int = 368, width: int = 496, threads: int = 1
    ) -> OpenPose: ...
    def estimate(self, image: NDArray[np.uint8]) -> list[ImageBody]: ...

@final
class Camera:
    def __new__(
        cls,
        width: int,
        height: int,
        matrix: ArrayLike,
        pose: ArrayLike | None = None,
        *,
        distortion: ArrayLike | None = None,
        model: Literal["radial", "fisheye"] = "radial",
        depth_noise: tuple[float, float] | None = None,
        name: str = ...,
    ) -> Camera: ...
    @staticmethod
    def looking_at(
        width: int,
        height: int,
        matrix: ArrayLike,
        eye: ArrayLike,
        target: ArrayLike,
        *,
        depth_noise: tuple[float, float] | None = None,
        name: str = ...,
    ) -> Camera: ...
    @staticmethod
    def read(path: _Path) -> list[Camera]: ...
    def at(self, pose: ArrayLike) -> Camera: ...
    def project(self, points: ArrayLike) -> _Array: ...
    def undistort(self, pixels: ArrayLike) -> _Array: ...
    def check_gravity(self, gravity: ArrayLike) -> None: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def matrix(self) -> _Array: ...
    @property
    def pose(self) -> _Array | None: ...
    @property
    def distortion(self) -> _Array | None: ...
    @property
    def name(self) -> str: ...

@final
class CameraPlacement:
    def __new__(cls, seen: ArrayLike, world: ArrayLike) -> CameraPlacement: ...
    @property
    def pose(self) -> _Array: ...
    @property
    def residuals(self) -> _Array: ...
    @property
    def deviation(self) -> float: ...

@final
class Lifter:
    def __new__(
        cls,
        camera: Camera,
        *,
        least_confidence: float = 0.4,
        pixel_sigma: float = 3.0,
        window: float = 0.03,
        least_share: float = 0.3,
        edge: float = 0.08,
        range: tuple[float, float] = ...,
        reach: float = 0.9,
        trunk_reach: float = 0.5,
        skin_sigma: float = 0.015,
    ) -> Lifter: ...
    def lift(
        self,
        body: ImageBody,
        depth: ArrayLike,
        *,
        unit: float = 0.001,
        heading: float | Callable[[Body], float | None] | None = None,
    ) -> Body: ...

@final
class MonocularLifter:
    def __new__(
        cls,
        camera: Camera,
        *,
        stature: float | None = None,
        pixel_noise: tuple[float, float] = ...,
        depth_sigma: float = 0.1,
        scale_sigma: float = 0.06,
        height_sigma: float = 0.05,
        tilt_sigma: float = 0.0349,
    ) -> MonocularLifter: ...
    def lift(self, body: ImageBody) -> Body | None: ...
    @property
    def stature(self) -> tuple[float, float] | None: ...

@final
class Triangulator:
    def __new__(
        cls,
        cameras: Sequence[Camera],
        *,
        pixel_noise: tuple[float, float] = ...,
        outlier: float = 3.0,
        least_confidence: float = 0.2,
        largest_sigma: float = 0.15,
    ) -> Triangulator: ...
    def body(self, views: Sequence[ImageBody | None]) -> Body: ...
    def people(self, views: Sequence[Sequence[ImageBody]]) -> list[Body]: ...

@final
class FollowedPerson:
    @property
    def id(self) -> int: ...
    @property
    def body(self) -> Body: ...
    @property
    def measured(self) -> Body: ...
    @property
    def is_in_frame(self) -> bool: ...
    @property
    def floor(self) -> _Array | None: ...
    @property
    def heading(self) -> float | None: ...
    @property
    def velocity(self) -> _Array | None: ...
    @property
    def age(self) -> float | None: ...
    @property
    def stature(self) -> tuple[float, float] | None: ...

@final
class People:
    def __new__(
        cls,
        *,
        place: ArrayLike | None = None,
        radius: float = 3.0,
        facing: float = 1.2,
        dwell: float = 0.3,
        release: float = 6.0,
        keep: float = 2.0,
        reach: float = 0.6,
        separate: float = 0.25,
        most: int = 8,
        least_confidence: float = 0.3,
    ) -> People: ...
    def update(self, time: float, bodies: Sequence[Body]) -> None: ...
    def heading_near(self, body: Body, now: float) -> float | None: ...
    @property
    def body(self) -> Body | None: ...
    @property
    def others(self) -> list[Body]: ...
    @property
    def engaged(self) -> FollowedPerson | None: ...
    @property
    def tracks(self) -> list[FollowedPerson]: ...

def nearest_person(
    camera: Camera, depth: ArrayLike, *, unit: float = 0.001
) -> tuple[float, float, float, float] | None: ...
def read_depth(path: _Path, *, unit: float = 0.001) -> _Floats: ...
def read_image(path: _Path, *, exif: bool = False) -> NDArray[np.uint8]: ...
def read_weights(path: _Path) -> dict[str, _Floats]: ...
