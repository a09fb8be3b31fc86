"""Prints a message of each type in the bytes of Cyclone DDS, for the tests of `examples`: `golden.py > golden.txt`."""

from messages import (
    CameraInfo, Float64MultiArray, Header, Image, JointState, MultiArrayDimension, MultiArrayLayout, Odometry, Point, Pose, PoseArray,
    PoseWithCovariance, Quaternion, RegionOfInterest, String, TFMessage, Time, Transform, TransformStamped, Twist, TwistStamped, TwistWithCovariance, Vector3,
)

STAMP = Time(1_700_000_000, 250_000_000)
NAMES = [f"panda_joint{joint}" for joint in range(1, 8)]
QUARTER = Quaternion(0.0, 0.0, 0.5**0.5, 0.5**0.5)
TWIST = Twist(Vector3(0.5, -0.25, 0.0), Vector3(0.0, 0.0, 0.125))

MESSAGES = [
    JointState(
        Header(STAMP, ""),
        ["finger", *reversed(NAMES)],
        [9.0, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1],
        [9.0, 7.0, 6.0, 5.0, 4.0, 3.0, 2.0, 1.0],
        [9.0, 70.0, 60.0, 50.0, 40.0, 30.0, 20.0, 10.0],
    ),
    Odometry(
        Header(STAMP, "odom"),
        "base_footprint",
        PoseWithCovariance(Pose(Point(1.5, -2.5, 0.0), QUARTER), [float(index) for index in range(36)]),
        TwistWithCovariance(TWIST, [-float(index) for index in range(36)]),
    ),
    PoseArray(Header(STAMP, "odom"), [Pose(Point(2.0, 0.01 * joint, 1.0)) for joint in range(25)]),
    TFMessage([TransformStamped(Header(STAMP, "map"), "odom", Transform(Vector3(1.0, 2.0, 0.0), QUARTER))]),
    String("Using The Drill"),
    TwistStamped(Header(STAMP, "base_footprint"), TWIST),
    Float64MultiArray(
        MultiArrayLayout([MultiArrayDimension("joint", 7, 7)], 0),
        [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0],
    ),
    Image(Header(STAMP, "camera_color_optical_frame"), 2, 3, "16UC1", 0, 6, [220, 5, 0, 0, 232, 3] * 2),
    CameraInfo(
        Header(STAMP, "camera_color_optical_frame"), 480, 640, "plumb_bob", [0.0] * 5,
        [615.0, 0.0, 319.5, 0.0, 616.0, 239.5, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        [615.0, 0.0, 319.5, 0.0, 0.0, 616.0, 239.5, 0.0, 0.0, 0.0, 1.0, 0.0], 1, 1, RegionOfInterest(1, 2, 3, 4, True),
    ),
]

if __name__ == "__main__":
    for message in MESSAGES:
        print(type(message).__name__, bytes(message.serialize(use_version_2=False)).hex())
