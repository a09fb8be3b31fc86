"""Vision: networks, people's joints in images, and their bodies in the world.

An image and its depth become a scene for the controller:

    camera = Camera(640, 480, matrix, pose)
    network = BlazePose("pose_solution_packed_assets.data", "pose_landmark_full.tflite")
    lifter, people = Lifter(camera), People()
    for time, image, depth in frames:
        seen = network.estimate(image, time)
        people.update(time, [lifter.lift(person.body, depth) for person in seen])
        controller.observe(Scene(people.body, others=people.others, time=time))

The package contains no weights; `docs/src/vision-poses.md` says where they are. Images are arrays of uint8, (height,
width, 3): red, green, blue. Positions are in the world [m]: x and y on the floor, z up.
"""

from ._ahqp import (
    BlazePose,
    Camera,
    CameraPlacement,
    FollowedPerson,
    ImageBody,
    Landmarks,
    Lifter,
    LinearSvm,
    MonocularLifter,
    OpenPose,
    People,
    Preprocessing,
    ResNet,
    Scores,
    SimpleBaseline,
    SlowOnly,
    SlowOnlyStream,
    TensorFlowLite,
    Training,
    Triangulator,
    nearest_person,
    read_depth,
    read_image,
    read_weights,
)

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
