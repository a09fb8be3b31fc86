"""Bad input of any kind gives an exception that says what is wrong."""

import numpy as np
import pytest
from support import PANDA, VISION

import ahqp
from ahqp import ergo, vision, whole_body

NAN, INF = float("nan"), float("inf")
HUGE = np.broadcast_to(np.float64(1.0), (10**9, 22))


def push(*args, n=2, **keywords):
    return ahqp.Hierarchy(n).push(*args, **keywords)


def solved(*args, n=2, **keywords):
    hierarchy = ahqp.Hierarchy(n)
    hierarchy.push(*args, **keywords)
    return ahqp.Solver(hierarchy).solve(hierarchy)


def ik():
    model = whole_body.Model.from_file(PANDA)
    tasks = {"tool": whole_body.PositionTask("panda_hand_tcp"), "posture": whole_body.PostureTask()}
    return whole_body.Ik(model, tasks, model.neutral())


MATRIX = [[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]]
JOINTS = np.full((25, 2), 100.0)
DETECTOR, LANDMARKS = VISION / "blaze_detector.tflite", VISION / "blaze_landmarks.tflite"
IMAGE = np.zeros((4, 4, 3), np.uint8)


def camera(matrix=MATRIX, pose=None, **how):
    return vision.Camera(640, 480, matrix, pose, **how)


def placed(**how):
    return vision.Camera.looking_at(640, 480, MATRIX, [0.0, 0.0, 1.0], [1.0, 0.0, 1.0], **how)


def lift(depth, body=None, **how):
    return vision.Lifter(placed()).lift(body or vision.ImageBody(JOINTS), depth, **how)


def pose_of(image, time=0.0):
    return vision.BlazePose(DETECTOR, LANDMARKS).estimate(image, time)


def operators(images, **how):
    return vision.TensorFlowLite(VISION / "operators.tflite", **how).infer(images)


def trained(samples, labels=(0, 1), classes=("a", "b"), **how):
    return vision.LinearSvm.train(samples, labels, classes, **how)[0]


def people(*frames):
    followed = vision.People()
    for time, bodies in frames:
        followed.update(time, bodies)


VISION_CASES = [
    (lambda: camera(np.eye(4)), ValueError, "matrix has shape"),
    (lambda: camera(2.0 * np.eye(3)), ValueError, "fx, 0, cx"),
    (lambda: camera([[600.0, 1.0, 0.0], [0.0, 600.0, 0.0], [0.0, 0.0, 1.0]]), ValueError, "skew"),
    (lambda: camera([[NAN, 0.0, 0.0], [0.0, 600.0, 0.0], [0.0, 0.0, 1.0]]), ahqp.Error, "fx is NaN"),
    (lambda: vision.Camera(0, 480, MATRIX), ahqp.Error, "width is 0"),
    (lambda: vision.Camera(-1, 480, MATRIX), OverflowError, "negative"),
    (lambda: camera(pose=np.ones((4, 4))), ValueError, "last row of pose"),
    (lambda: camera(pose=[[1, 0, 0, NAN], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]), ValueError, "pose must be finite"),
    (lambda: camera(distortion=[0.1] * 6), ValueError, "4, 5 or 8"),
    (lambda: camera(distortion=[NAN] * 4), ValueError, "distortion must be finite"),
    (lambda: camera(distortion=[0.1] * 5, model="fisheye"), ValueError, "fisheye"),
    (lambda: camera(model="barrel"), ValueError, "model is \"barrel\""),
    (lambda: placed(depth_noise=(-1.0, 0.0)), ahqp.Error, "noise.constant is -1"),
    (lambda: placed().project([1.0, 2.0, 3.0]), ValueError, "points has shape"),
    (lambda: placed().project([[1.0, 2.0]]), ValueError, "3 columns"),
    (lambda: vision.Camera.looking_at(640, 480, MATRIX, [0, 0, 1], [0, 0, 2]), ahqp.Error, "the camera's pose"),
    (lambda: vision.Camera.read("nowhere.yaml"), FileNotFoundError, "nowhere.yaml"),
    (lambda: vision.Camera.read(PANDA), ValueError, "calibration"),
    (lambda: vision.CameraPlacement([[0, 0, 1]], [[0, 0, 1]] * 2), ValueError, "seen has 1 points"),
    (lambda: vision.CameraPlacement([[0, 0, 1]] * 2, [[0, 0, 1]] * 2), ahqp.Error, "three or more"),
    (lambda: vision.CameraPlacement([[0, 0, 1]] * 3, [[0, 0, 1]] * 3), ahqp.Error, "common line"),
    (lambda: vision.CameraPlacement([[NAN, 0, 1]] * 3, [[0, 0, 1]] * 3), ahqp.Error, "NaN"),
    (lambda: vision.Lifter(camera()), ValueError, "no pose"),
    (lambda: vision.Lifter(camera(pose=np.eye(4), distortion=[0.1] * 4)), ValueError, "rectified"),
    (lambda: vision.Lifter(camera(pose=np.diag([1.0, -1.0, -1.0, 1.0])).at(np.eye(4)), window=NAN), ahqp.Error, "window"),
    (lambda: vision.Lifter(placed(), range=(5.0, 1.0)), ahqp.Error, "range"),
    (lambda: lift(np.zeros((4, 4))), ahqp.Error, "the depth image has 4 × 4 pixels"),
    (lambda: lift(np.zeros(4)), ValueError, r"depth has shape \(4,\)"),
    (lambda: lift(np.zeros((0, 0))), ahqp.Error, "depth image"),
    (lambda: lift(np.zeros((480, 640), np.int64)), TypeError, "uint16 in units"),
    (lambda: lift(None), TypeError, "depth must be an array of real numbers"),
    (lambda: lift(np.zeros((480, 640), np.uint16), unit=NAN), ahqp.Error, "depth_scale is NaN"),
    (lambda: lift(np.zeros((480, 640)), heading=INF), ValueError, "heading is inf"),
    (lambda: lift(np.zeros((480, 640)), heading="north"), TypeError, "heading"),
    (lambda: lift(np.zeros((480, 640)), heading=lambda body: "north"), TypeError, "heading"),
    (lambda: vision.ImageBody(JOINTS[:24]), ValueError, "BODY_25 has 25 joints"),
    (lambda: vision.ImageBody(JOINTS, layout="COCO"), ValueError, "layout is \"COCO\""),
    (lambda: vision.ImageBody(JOINTS, 2.0), ahqp.Error, "confidence"),
    (lambda: vision.ImageBody(JOINTS, NAN), ahqp.Error, "confidence"),
    (lambda: vision.ImageBody(JOINTS, [1.0]), ValueError, "confidences has 1 entries"),
    (lambda: vision.ImageBody(INF * JOINTS), ValueError, "finite, or NaN"),
    (lambda: vision.ImageBody(JOINTS, metric=JOINTS), ValueError, "metric has shape"),
    (lambda: vision.MonocularLifter(camera()), ahqp.Error, "place of the camera"),
    (lambda: vision.MonocularLifter(placed(), stature=175.0), ahqp.Error, "stature is 175"),
    (lambda: vision.MonocularLifter(placed()).lift(vision.ImageBody(JOINTS)), ValueError, "no metric joints"),
    (lambda: vision.Triangulator([placed()]), ahqp.Error, "2 to 16"),
    (lambda: vision.Triangulator([placed(), camera(name="left")]), ahqp.Error, "not known of left"),
    (lambda: vision.Triangulator([placed()] * 2, outlier=NAN), ahqp.Error, "outlier"),
    (lambda: vision.Triangulator([placed()] * 2).body([None]), ValueError, "2 cameras"),
    (lambda: vision.Triangulator([placed()] * 2).people([[]] * 3), ValueError, "2 cameras"),
    (lambda: vision.Triangulator([placed()] * 2).body([1, 2]), TypeError, "views"),
    (lambda: vision.People(most=0), ahqp.Error, "most"),
    (lambda: vision.People(place=[NAN, 0.0]), ahqp.Error, "place"),
    (lambda: people((NAN, [])), ahqp.Error, "time"),
    (lambda: people((1.0, []), (0.5, [])), ahqp.Error, "time"),
    (lambda: people((0.0, [vision.ImageBody(JOINTS)])), TypeError, "bodies"),
    (lambda: vision.nearest_person(placed(), np.zeros((4, 4))), ValueError, "640 × 480"),
    (lambda: vision.BlazePose(LANDMARKS, DETECTOR), ahqp.Error, "no detector of BlazePose"),
    (lambda: vision.BlazePose("nowhere.tflite", LANDMARKS), FileNotFoundError, "nowhere.tflite"),
    (lambda: vision.BlazePose(DETECTOR, PANDA), ahqp.Error, "panda.urdf"),
    (lambda: vision.BlazePose(DETECTOR, 3), TypeError, "landmarks must be a path"),
    (lambda: vision.BlazePose(DETECTOR, LANDMARKS, most=0), ahqp.Error, "most is 0"),
    (lambda: vision.BlazePose(DETECTOR, LANDMARKS, presence=NAN), ahqp.Error, "presence is NaN"),
    (lambda: vision.BlazePose(DETECTOR, LANDMARKS, threads=0), ahqp.Error, "0 threads"),
    (lambda: pose_of(IMAGE[:0]), ahqp.Error, "0 × 4 × 3"),
    (lambda: pose_of(IMAGE[..., :1]), ahqp.Error, "4 × 4 × 1"),
    (lambda: pose_of(IMAGE[0]), ValueError, r"must be \(height, width, 3\)"),
    (lambda: pose_of(IMAGE / 255.0), TypeError, "one of uint8"),
    (lambda: pose_of(np.zeros((4, 4, 3))), TypeError, "one of uint8"),
    (lambda: pose_of([["a"]]), TypeError, "image must be an array of real numbers"),
    (lambda: pose_of(IMAGE, NAN), ValueError, "time is NaN"),
    (lambda: vision.SimpleBaseline({}), ahqp.Error, "conv1"),
    (lambda: vision.OpenPose({}), ahqp.Error, "conv1_1"),
    (lambda: vision.OpenPose({}, height=2**64 - 1), ahqp.Error, "too large"),
    (lambda: vision.ResNet("nowhere.pth"), FileNotFoundError, "nowhere.pth"),
    (lambda: vision.ResNet(PANDA.parent), OSError, "urdf"),
    (lambda: vision.ResNet(PANDA), ahqp.Error, "panda.urdf: not a checkpoint"),
    (lambda: vision.ResNet(None), TypeError, "weights must be a path, or a dict"),
    (lambda: vision.ResNet({"fc.bias": "text"}), TypeError, "fc.bias must be an array"),
    (lambda: vision.ResNet({3: [0.5]}), TypeError, "int"),
    (lambda: vision.SlowOnlyStream(VISION / "plain.pth"), ahqp.Error, "give those of SlowOnly"),
    (lambda: vision.read_weights(VISION / "trunc30.jpg"), ahqp.Error, "trunc30.jpg: not a checkpoint"),
    (lambda: vision.read_image(VISION / "trunc30.jpg"), ahqp.Error, "trunc30.jpg"),
    (lambda: vision.read_image(PANDA), ahqp.Error, "no JPEG or PNG"),
    (lambda: vision.read_image("nowhere.png"), FileNotFoundError, "nowhere.png"),
    (lambda: vision.read_depth(VISION / "trunc30.jpg"), ahqp.Error, "trunc30.jpg"),
    (lambda: vision.TensorFlowLite(b""), ahqp.Error, "TensorFlow Lite"),
    (lambda: vision.TensorFlowLite(LANDMARKS, outputs=[]), ValueError, "outputs is empty"),
    (lambda: vision.TensorFlowLite(LANDMARKS, outputs=[9]), ahqp.Error, "output"),
    (lambda: vision.TensorFlowLite(LANDMARKS, threads=10**6), ahqp.Error, "threads"),
    (lambda: operators(np.zeros((13, 18, 3))), ValueError, "rows, columns, channels"),
    (lambda: operators(np.zeros((0, 13, 18, 3))), ahqp.Error, "at least one"),
    (lambda: operators(np.zeros((1, 13, 18, 4))), ahqp.Error, "channels"),
    (lambda: operators(np.zeros((1, 1, 1, 3))), ahqp.Error, "small"),
    (lambda: operators(np.full((1, 13, 18, 3), NAN)), ahqp.Error, "NaN"),
    (lambda: operators(np.full((1, 13, 18, 3), 3e38)), ahqp.Error, "overflows"),
    (lambda: vision.Preprocessing(), ValueError, "short_side and square"),
    (lambda: vision.Preprocessing("keras", square=4), ValueError, "library is \"keras\""),
    (lambda: vision.Preprocessing(square=0).image(IMAGE), ahqp.Error, "resize is 0"),
    (lambda: vision.Preprocessing(square=8, crop=9).image(IMAGE), ahqp.Error, "9 × 9 for the crop"),
    (lambda: vision.Preprocessing.SURFACE.clip([]), ahqp.Error, "no frames"),
    (lambda: vision.Preprocessing.SURFACE.clip([IMAGE, IMAGE[:2]]), ahqp.Error, "first frame"),
    (lambda: vision.Preprocessing.SURFACE.clip(3), TypeError, "int"),
    (lambda: trained([[0.0], [1.0]], [0, 2]), ahqp.Error, "sample 1 is of class 2"),
    (lambda: trained([[0.0], [1.0]], [0, 0.5]), ValueError, "a label is 0.5"),
    (lambda: trained([[0.0], [1.0]], [0, -1]), ValueError, "a label is -1"),
    (lambda: trained([[0.0], [NAN]]), ahqp.Error, "NaN"),
    (lambda: trained(np.zeros((0, 1)), []), ahqp.Error, "sample"),
    (lambda: trained([[0.0], [1.0]], cost=0.0), ahqp.Error, "cost is 0"),
    (lambda: trained([[0.0], [1.0]], loss="log"), ValueError, "squared_hinge"),
    (lambda: trained([[0.0], [1.0]], class_weights="even"), ValueError, "balanced"),
    (lambda: trained([[0.0], [1.0]]).classify([0.0]), ValueError, "samples has shape"),
    (lambda: trained([[0.0], [1.0]]).decide([[0.0, 1.0]]), ahqp.Error, "2 features"),
    (lambda: vision.LinearSvm(["a", "b"], [[INF]], [0.0]), ahqp.Error, "inf"),
    (lambda: vision.LinearSvm(["a"], [[1.0]], [0.0]), ahqp.Error, "class"),
    (lambda: vision.LinearSvm.load(PANDA), ahqp.Error, "panda.urdf"),
    (lambda: vision.LinearSvm.load("nowhere.svm"), FileNotFoundError, "nowhere.svm"),
]

CASES = [
    (lambda: ahqp.Hierarchy(0), ValueError, "no variables"),
    (lambda: ahqp.Hierarchy(-1), OverflowError, "negative"),
    (lambda: ahqp.Hierarchy(10**15), ValueError, "4096 at most"),
    (lambda: ahqp.Hierarchy(None), TypeError, "None"),
    (lambda: ahqp.Hierarchy(2.0), TypeError, "float"),
    (lambda: push(None), TypeError, "A must be an array of real numbers; it is one of object"),
    (lambda: push("text"), TypeError, "A must be an array of real numbers"),
    (lambda: push([[1j, 0]]), TypeError, "complex"),
    (lambda: push([[1.0, 2.0], [3.0]]), TypeError, "A must be an array of numbers"),
    (lambda: push([["1.0", "2.0"]]), TypeError, "A must be an array of real numbers"),
    (lambda: push(np.array([["2026-01-01", "2026-01-01"]], "M8[D]")), TypeError, "datetime"),
    (lambda: push([1.0, 2.0]), ValueError, r"A has shape \(2,\); it must have two dimensions"),
    (lambda: push(np.ones((1, 1, 2))), ValueError, "two dimensions"),
    (lambda: push(np.float64(3.0)), ValueError, "two dimensions"),
    (lambda: push(np.ones((1, 3))), ahqp.Error, "3, but 2 was expected"),
    (lambda: push(np.ones((1, 0))), ahqp.Error, "0, but 2 was expected"),
    (lambda: push(HUGE, n=22), ValueError, "entries; it must have"),
    (lambda: push(np.ones((1, 2)), [1.0, 2.0]), ValueError, "lower has 2 entries; it must have 1"),
    (lambda: push(np.ones((1, 2)), upper=[[1.0]]), ValueError, "one dimension"),
    (lambda: push(np.ones((1, 2)), upper=3.0), ValueError, "one dimension"),
    (lambda: push(np.ones((1, 2)), weights=[-1.0]), ahqp.Error, "weight of row 0"),
    (lambda: push(np.ones((1, 2)), name=3), TypeError, "name"),
    (lambda: push(np.ones((1, 2)), hard="yes"), TypeError, "hard"),
    (lambda: solved([[NAN, 1.0]], [1.0]), ahqp.Error, "not finite"),
    (lambda: solved([[INF, 1.0]], [1.0]), ahqp.Error, "not finite"),
    (lambda: solved([[1.0, 1.0]], [NAN]), ahqp.Error, "NaN"),
    (lambda: solved([[1.0, 1.0]], [2.0], [1.0]), ahqp.Error, "leave nothing between"),
    (lambda: ahqp.Hierarchy(2).update(0, A=np.ones((1, 2))), ValueError, "no level 0"),
    (lambda: ahqp.Hierarchy(2).set_bounds([0.0], [1.0]), ValueError, "lower has 1 entries"),
    (lambda: ahqp.Hierarchy(2).name_variables(["one"]), ahqp.Error, "names of the variables"),
    (lambda: ahqp.Hierarchy(2).push_quadratic(np.ones((2, 3)), [1.0, 1.0]), ahqp.Error, "Hessian"),
    (lambda: ahqp.Solver(None), TypeError, "hierarchy"),
    (lambda: ahqp.Solver(ahqp.Hierarchy(2), rank_tolerance=NAN), ahqp.Error, "rank_tolerance"),
    (lambda: ahqp.Solver(ahqp.Hierarchy(2)).solve(ahqp.Hierarchy(3)), ahqp.Error, "shape"),
    (lambda: ahqp.Solver(ahqp.Hierarchy(2)).certificate(ahqp.Hierarchy(2)), ahqp.Error, "certif"),
    (lambda: ahqp.solve(np.eye(2), [1, 1], [1, 1], [1]), ValueError, "breaks must be"),
    (lambda: ahqp.solve(np.eye(2), [1, 1], [1, 1], [2, 1]), ValueError, "breaks must be"),
    (lambda: ahqp.solve(np.eye(2), [1, 1], [1, 1], [0.5, 2]), ValueError, "breaks must be"),
    (lambda: ahqp.solve(np.eye(2), [1, 1], [1, 1], []), ValueError, "breaks must be"),
    (lambda: ahqp.solve(np.ones((0, 0)), [], [], []), ahqp.Error, "no variables"),
    (lambda: ahqp.Limits([1.0], [0.0], [1.0], [1.0]), ahqp.Error, "joint 0"),
    (lambda: whole_body.Model("<robot"), ahqp.Error, "line 1"),
    (lambda: whole_body.Model.from_file("nowhere.urdf"), FileNotFoundError, "nowhere.urdf"),
    (lambda: whole_body.Model.from_file(PANDA, base="flying"), ValueError, "fixed"),
    (lambda: whole_body.Model.from_file(PANDA, limits={"panda_joint1": {"speed": 1.0}}), ValueError, "speed"),
    (lambda: whole_body.Model.from_file(PANDA, gravity=[0.0]), ValueError, "gravity has 1 entries"),
    (lambda: whole_body.Data(whole_body.Model.from_file(PANDA)).pose("panda_hand_tcp"), ahqp.Error, "configuration"),
    (lambda: whole_body.Data(whole_body.Model.from_file(PANDA)).pose("hand"), ahqp.Error, "panda_hand"),
    (lambda: ik().step([0.0], 1e-3), ValueError, "q has 1 entries; it must have 7"),
    (lambda: ik().step([NAN] * 7, 1e-3), ahqp.Error, "NaN"),
    (lambda: ik().step([0.0] * 7, -1.0), ahqp.Error, "positive"),
    (lambda: ik().set_target("foot", [0.0] * 3), ValueError, "posture, tool"),
    (lambda: ik().set_target("tool", [NAN] * 3), ahqp.Error, "NaN"),
    (lambda: ik().set_target("tool", np.eye(4)), ValueError, "one dimension"),
    (lambda: whole_body.Ik(whole_body.Model.from_file(PANDA), {"task": 3}), TypeError, "task"),
    (lambda: whole_body.Ik(whole_body.Model.from_file(PANDA), {}), ahqp.Error, "no level"),
    (lambda: whole_body.PositionTask("tool", axes="abc"), ValueError, "xyz"),
    (lambda: whole_body.AxisTask("tool", [0.0, 0.0, 0.0]), ValueError, "not zero"),
    (lambda: ergo.Worksheet(trunk_flexion=NAN).score(), ahqp.Error, "trunk_flexion"),
    (lambda: ergo.Worksheet(coupling="sticky").score(), ValueError, "unacceptable"),
    (lambda: ergo.Worksheet(trunk=1.0), TypeError, "trunk"),
    (lambda: ergo.RulaWorksheet(load=-1.0).score(), ahqp.Error, "load"),
    (lambda: ergo.Person(170.0), ahqp.Error, "stature"),
    (lambda: ergo.Person(1.7, segments={"tail": 0.5}), ValueError, "forearm"),
    (lambda: ergo.Person(1.7).posture_at([3.0, 0.0, 1.0]), ahqp.Error, "cannot be"),
    (lambda: ergo.Person(1.7).posture_at([0.4, 0.0, 1.0], side="both"), ValueError, "left"),
    (lambda: ergo.ErgonomicsMap(ergo.Person(1.7), spacing=1e-9), ahqp.Error, "spacing"),
    (lambda: ergo.ErgonomicsMap.load("nowhere.map"), FileNotFoundError, "nowhere.map"),
    (lambda: ergo.ErgonomicsMap.load(PANDA), ahqp.Error, "not a usable ergonomics map"),
    (lambda: ergo.ErgonomicsMap.load(PANDA.parent), OSError, "urdf"),
]


@pytest.mark.parametrize("call, kind, text", CASES + VISION_CASES)
def test_bad_input_is_named(call, kind, text):
    with pytest.raises(kind, match=text) as caught:
        call()
    # Not the exception of a panic, which is no Exception.
    assert isinstance(caught.value, Exception)


class Raises:
    """An object whose conversion to an array ends in an exception."""

    def __init__(self, error):
        self.error = error

    def __array__(self, *_args, **_keywords):
        raise self.error


@pytest.mark.parametrize("error", [KeyboardInterrupt(), MemoryError(), SystemExit(3)])
def test_what_is_no_wrong_argument_comes_through(error):
    for call in [
        lambda: ahqp.solve(Raises(error), [1, 1], [1, 1], [2]),
        lambda: ahqp.Hierarchy(2).name_variables(["a", "b"]) or ahqp.Limits(Raises(error), [1.0], [1.0], [1.0]),
        lambda: ik().step(Raises(error), 1e-3),
    ]:
        with pytest.raises(type(error)):
            call()
    with pytest.raises(TypeError, match="array of numbers"):
        ik().step(Raises(RuntimeError("no array")), 1e-3)


def test_a_file_without_an_end_is_refused():
    for read in (vision.Camera.read, vision.read_weights, vision.ResNet):
        with pytest.raises((OSError, ahqp.Error), match="/dev/zero"):
            read("/dev/zero")
    with pytest.raises(OSError, match="larger than a URDF can be"):
        whole_body.Model.from_file("/dev/zero")


def test_a_rotation_that_is_none_is_refused():
    model = whole_body.Model.from_file(PANDA)
    tasks = {"turn": whole_body.OrientationTask("panda_hand_tcp"), "pose": whole_body.FrameTask("panda_hand_tcp")}
    solver = whole_body.Ik(model, tasks, model.neutral())
    for target, text in [
        (2.0 * np.eye(3), "identity"),
        (-np.eye(3), "det"),
        ([0.0, 0.0, 0.0, 2.0], "norm"),
        ([0.0, 0.0, 1.0], "quaternion"),
        (np.full((3, 3), NAN), "identity"),
    ]:
        with pytest.raises(ValueError, match=text):
            solver.set_target("turn", target)
    with pytest.raises(ValueError, match="last row"):
        solver.set_target("pose", np.ones((4, 4)))
    with pytest.raises(ValueError, match=r"\(4, 4\)"):
        solver.set_target("pose", np.eye(3))


def test_input_is_never_changed():
    matrix, bound = np.ones((1, 2)), np.ones(1)
    before = matrix.copy(), bound.copy()
    solved(matrix, bound, bound)
    assert np.array_equal(matrix, before[0]) and np.array_equal(bound, before[1])
