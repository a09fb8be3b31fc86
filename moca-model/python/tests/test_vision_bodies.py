"""Bodies from images: pose networks, cameras, lifting, people, and their way to the controller."""

import subprocess
import threading

import numpy as np
import pytest
from support import VISION, png, run_example

from ahqp.collaboration import Body, Controller, Scene
from ahqp.ergo import ErgonomicsMap, Person
from ahqp.vision import (
    BlazePose,
    Camera,
    CameraPlacement,
    ImageBody,
    Lifter,
    MonocularLifter,
    People,
    Triangulator,
    nearest_person,
)

DETECTOR, LANDMARKS = VISION / "blaze_detector.tflite", VISION / "blaze_landmarks.tflite"
MATRIX = np.array([[615.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]])
AHEAD = Camera.looking_at(640, 480, MATRIX, [0.0, 0.0, 1.2], [3.0, 0.0, 1.2])
# The optical axes in the world of a level camera that looks along x.
LEVEL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])


def pose(rotation, place):
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, place
    return matrix


def rays(pixels):
    """Directions through pixels in the optical frame, z = 1."""
    return np.column_stack([pixels, np.ones(len(pixels))]) @ np.linalg.inv(MATRIX).T


def turned(axis, angle):
    """A rotation about an axis, by Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


def anchor(row, column):
    """The hips of the person whom blaze_detector.tflite finds where this pixel of its input is white."""
    index = 46 * (row // 32 * 7 + column // 32)
    index, side, step = (index, 28, 8.0) if index < 1568 else (index - 1568, 14, 16.0)
    return np.array([index // 2 % side + 0.5, index // 2 // side + 0.5]) * step


def frame(detected, present):
    """An image in which the networks of blaze_pose.py find people in regions of 140 pixels."""
    image = np.zeros((224, 224, 3), np.uint8)
    for row, column in detected:
        image[row, column] = 255
    for person in present:
        x, y = np.round(anchor(*person) - 70).astype(int)
        image[max(y - 2, 0) : y + 3, max(x - 2, 0) : x + 3] = 255
    return image


ONE, OTHER = (64, 96), (160, 160)


def test_landmarks_are_where_their_region_is():
    network = BlazePose(DETECTOR, LANDMARKS.read_bytes())
    (person,) = network.estimate(frame([ONE], [ONE]), 0.0)
    assert person.score > 0.99
    index = np.arange(33)[:, None]
    corner = anchor(*ONE) - 70
    assert person.positions == pytest.approx(corner + ([64, 32] + 4 * index) / 256 * 140, abs=1e-3)
    assert person.depths == pytest.approx(np.full(33, 16 / 256 * 140), abs=1e-3)
    assert person.metric == pytest.approx(np.hstack([index / 64, index / 32, index * 0 + 1.0]), abs=1e-3)
    assert person.visibility == pytest.approx(np.full(33, 1 / (1 + np.exp(-4))), abs=1e-6)
    assert np.all(person.presence > person.visibility)
    body = person.body
    shoulders = person.positions[[11, 12]]
    names = Body.JOINTS
    assert np.array_equal(body.joints[names.index("left shoulder")], shoulders[0])
    assert body.joints[names.index("neck")] == pytest.approx(shoulders.mean(0))
    assert body.confidences[names.index("nose")] == pytest.approx(person.visibility[0])
    assert body.metric[names.index("right wrist")] == pytest.approx(person.metric[16])
    assert "left small toe" not in body.seen and len(body.seen) == 23


def test_people_are_followed_until_gone():
    network = BlazePose(DETECTOR, LANDMARKS, most=3, threads=2)
    assert network.estimate(frame([], [ONE]), 0.0) == []
    assert len(network.estimate(frame([ONE, OTHER], [ONE, OTHER]), 0.1)) == 2
    # Views of any strides are read as they are seen.
    both = frame([], [ONE, OTHER])
    assert len(network.estimate(both[:, ::-1].copy()[:, ::-1], 0.2)) == 2
    assert len(network.estimate(np.asfortranarray(both), 0.3)) == 2
    assert network.estimate(frame([], []), 0.4) == []
    assert len(network.estimate(frame([ONE], [ONE]), 0.5)) == 1
    network.forget()
    assert network.estimate(frame([], [ONE]), 0.6) == []


def test_a_network_is_of_one_thread_at_a_time():
    network, image = BlazePose(DETECTOR, LANDMARKS), frame([ONE], [ONE])
    failures = []

    def estimate():
        for time in range(6):
            try:
                network.estimate(image, float(time))
            except RuntimeError as error:
                failures.append(str(error))

    threads = [threading.Thread(target=estimate) for _ in range(2)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert all("another thread is using this BlazePose" in failure for failure in failures)
    assert len(network.estimate(image, 99.0)) == 1


def test_joints_of_other_networks():
    joints = np.full((17, 2), np.nan)
    joints[[5, 6, 9]] = [[120, 80], [80, 84], [130, 150]]
    body = ImageBody(joints, np.linspace(0.1, 0.9, 17), layout="COCO-17")
    assert body.seen == ["neck", "right shoulder", "left shoulder", "left wrist"]
    assert body.confidences[Body.JOINTS.index("neck")] == pytest.approx(0.35)  # the lower of 0.35 and 0.4
    assert body.metric is None
    assert ImageBody.LAYOUTS["BlazePose"] == 33 and ImageBody.LAYOUTS["BODY_25"] == 25


def test_a_camera_is_a_pinhole_with_a_lens():
    rotation, place = LEVEL @ turned([1.0, 0.2, 0.1], 0.3), np.array([0.5, -0.2, 1.4])
    camera = Camera(640, 480, MATRIX, pose(rotation, place), name="left")
    points = np.array([[3.0, 0.1, 1.0], [2.0, -0.5, 1.6]])
    seen = (points - place) @ rotation @ MATRIX.T
    assert camera.project(points) == pytest.approx(seen[:, :2] / seen[:, 2:])
    assert camera.size == (640, 480) and camera.name == "left" and camera.distortion is None
    assert np.array_equal(camera.matrix, MATRIX) and camera.pose == pytest.approx(pose(rotation, place))
    # OpenCV's model of a lens.
    k1, k2, p1, p2, k3 = factors = [-0.1, 0.02, 1e-3, -5e-4, 0.01]
    lens = Camera(640, 480, MATRIX, camera.pose, distortion=factors)
    x, y = (seen[:, :2] / seen[:, 2:] - MATRIX[:2, 2]).T / np.array([[615.0], [600.0]])
    square = x * x + y * y
    radial = 1.0 + square * (k1 + square * (k2 + square * k3))
    shown = [
        x * radial + 2 * p1 * x * y + p2 * (square + 2 * x * x),
        y * radial + p1 * (square + 2 * y * y) + 2 * p2 * x * y,
    ]
    shown = np.column_stack(shown) * [615.0, 600.0] + MATRIX[:2, 2]
    assert lens.project(points) == pytest.approx(shown)
    assert lens.undistort(shown) == pytest.approx(camera.project(points), abs=1e-6)
    assert lens.distortion.tolist() == [*factors, 0.0, 0.0, 0.0]
    # Gravity in the optical frame.
    camera.check_gravity(rotation.T @ [0.0, 0.0, -9.81])
    with pytest.raises(ValueError, match="gravity"):
        camera.check_gravity(rotation.T @ [0.0, 0.0, 9.81])


def test_a_calibration_is_read(tmp_path):
    text = f"""%YAML:1.0
image_width: 640
image_height: 480
camera_matrix: {{rows: 3, cols: 3, data: {MATRIX.ravel().tolist()}}}
distortion_coefficients: {{rows: 1, cols: 5, data: [-0.1, 0.02, 0.0, 0.0, 0.0]}}
"""
    (tmp_path / "webcam.yaml").write_text(text)
    (camera,) = Camera.read(tmp_path / "webcam.yaml")
    assert camera.name == "webcam" and camera.pose is None and camera.distortion[:2].tolist() == [-0.1, 0.02]
    with pytest.raises(ValueError, match=r"no pose; camera.at"):
        camera.project([[1.0, 0.0, 1.0]])
    assert camera.at(np.eye(4)).project([[0.0, 0.0, 1.0]]) == pytest.approx(MATRIX[None, :2, 2])


def test_a_camera_is_placed_by_points():
    rng = np.random.default_rng(5)
    rotation, place = LEVEL @ turned([0.3, 1.0, 0.2], 0.4), np.array([1.0, 0.5, 2.0])
    world = rng.uniform(-1.0, 1.0, (8, 3))
    seen = (world - place) @ rotation
    found = CameraPlacement(seen, world)
    assert found.pose == pytest.approx(pose(rotation, place)) and found.deviation < 1e-9
    noisy = world + 0.01 * rng.normal(size=world.shape)
    found = CameraPlacement(seen, noisy)
    # The least squares of Kabsch by numpy.
    one, other = seen - seen.mean(0), noisy - noisy.mean(0)
    left, _, right = np.linalg.svd(other.T @ one)
    best = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    assert found.pose[:3, :3] == pytest.approx(best)
    errors = np.linalg.norm(one @ best.T - other, axis=1)
    assert found.residuals == pytest.approx(errors)
    assert found.deviation == pytest.approx(np.sqrt((errors**2).mean()))
    assert AHEAD.at(found.pose).pose == pytest.approx(found.pose)


def test_joints_lie_behind_the_surface_of_the_depth_image():
    joints = np.full((25, 2), np.nan)
    nose, wrist = Body.JOINTS.index("nose"), Body.JOINTS.index("left wrist")
    joints[[nose, wrist]] = [[300.0, 100.0], [400.0, 200.0]]
    body = ImageBody(joints, 0.9)
    millimetres = np.full((480, 640), 2000, np.uint16)
    lifted = Lifter(AHEAD, pixel_sigma=2.0).lift(body, millimetres)
    assert lifted.seen == ["nose", "left wrist"] and lifted.confidences[nose] == pytest.approx(0.9)
    # The nose is on the skin, and a wrist 0.03 m behind it on its ray.
    eye, directions = np.array([0.0, 0.0, 1.2]), rays(joints[[nose, wrist]])
    depths = 2.0 + np.array([0.0, 0.03]) / np.linalg.norm(directions, axis=1)
    assert lifted.joints[[nose, wrist]] == pytest.approx(eye + depths[:, None] * directions @ LEVEL.T, abs=1e-6)
    # Across the rays, errors are those of the keypoints.
    across = lifted.covariances[nose][2, 2] - directions[0, 1] ** 2 * lifted.covariances[nose][0, 0]
    assert across == pytest.approx((2.0 * 2.0 / 600.0) ** 2, rel=1e-3)
    # The same depths in other units, as floats, with holes, and in another order in memory.
    same = [
        (np.asfortranarray(millimetres), {}),
        (millimetres // 10, {"unit": 0.01}),
        (millimetres * 0.001, {}),
        (np.full((480, 640), 2.0, np.float32), {"heading": np.pi}),
    ]
    for depth, how in same:
        assert Lifter(AHEAD).lift(body, depth, **how).joints == pytest.approx(lifted.joints, abs=1e-6, nan_ok=True)
    holes = millimetres * 0.001
    holes[90:110] = np.nan
    assert Lifter(AHEAD).lift(body, holes).seen == ["left wrist"]
    assert Lifter(AHEAD, least_confidence=0.95).lift(body, millimetres).seen == []


def test_a_heading_may_be_asked_for():
    joints = np.full((25, 2), np.nan)
    left, right = Body.JOINTS.index("left hip"), Body.JOINTS.index("right hip")
    joints[[left, right]] = [[340.0, 300.0], [300.0, 300.0]]
    lifter, body, depth = Lifter(AHEAD), ImageBody(joints), np.full((480, 640), 2.0)
    asked = []

    def heading(before):
        asked.append(before)
        return np.pi / 2

    aside = lifter.lift(body, depth, heading=heading)
    assert len(asked) == 1 and asked[0].seen == ["right hip", "left hip"]
    assert np.array_equal(aside.joints, lifter.lift(body, depth, heading=np.pi / 2).joints, equal_nan=True)
    facing = lifter.lift(body, depth, heading=lambda before: None)
    # The hip on the far side of a person who stands sideways is deeper in them.
    assert aside.joints[[left, right], 0].max() > facing.joints[[left, right], 0].max() + 0.05
    with pytest.raises(ZeroDivisionError):
        lifter.lift(body, depth, heading=lambda before: 1 / 0)


STANDING = Body.standing(Person(1.75), [3.0, 0.2], np.pi)


def seen_by(camera, body, metric=None):
    return ImageBody(camera.project(body.joints), body.confidences, metric=metric)


def test_several_views_give_the_joints():
    eyes = [[0.0, 0.0, 1.5], [3.0, -3.0, 1.8], [6.0, 0.5, 1.6]]
    cameras = [Camera.looking_at(640, 480, MATRIX, eye, [3.0, 0.2, 1.0]) for eye in eyes]
    triangulator = Triangulator(cameras)
    views = [seen_by(camera, STANDING) for camera in cameras]
    body = triangulator.body(views)
    assert body.seen == STANDING.seen
    assert body.joints == pytest.approx(STANDING.joints, abs=1e-6, nan_ok=True)
    assert triangulator.body([views[0], None, views[2]]).seen
    assert triangulator.body([views[0], None, None]).seen == []
    # Two people, in another order in each image.
    other = Body.standing(Person(1.6), [3.4, -0.9], 1.0)
    both = [[seen_by(camera, person) for person in (STANDING, other)] for camera in cameras]
    both[1].reverse()
    people = sorted(triangulator.people([*both[:2], both[2][:1]]), key=lambda body: body.joints[1, 1], reverse=True)
    assert len(people) == 2
    for found, truth in zip(people, (STANDING, other)):
        assert found.joints == pytest.approx(truth.joints, abs=1e-6, nan_ok=True)


def test_one_camera_without_depth_places_a_person():
    camera = Camera.looking_at(640, 480, MATRIX, [0.0, 0.2, 0.95], [3.0, 0.2, 0.95])
    middle = STANDING.joints[Body.JOINTS.index("mid hip")]
    metric = (STANDING.joints - middle) @ LEVEL
    lifter = MonocularLifter(camera, stature=1.75)
    # The network takes the person for smaller than they are.
    for _ in range(3):
        body = lifter.lift(seen_by(camera, STANDING, 0.9 * metric))
    assert body.seen == STANDING.seen
    error = np.linalg.norm(body.joints - STANDING.joints, axis=1)
    # Four per cent of three metres, which people's legs differ by.
    assert np.nanmax(error) < 0.12
    stature, sigma = lifter.stature
    assert stature == pytest.approx(1.75, abs=0.08) and 0.01 < sigma < 0.2
    assert np.isfinite(body.covariances[Body.JOINTS.index("neck")]).all()
    few = np.full((25, 2), np.nan)
    few[0] = 320.0, 100.0
    assert lifter.lift(ImageBody(few, metric=metric)) is None


def test_people_are_told_apart_over_time():
    people, other = People(), Body.standing(Person(1.6), [4.0, 2.5], 0.0)
    for tick in range(60):
        walking = Body.standing(Person(1.75), [2.5 - 0.01 * tick, 0.0], np.pi)
        people.update(0.05 * tick, [other, walking])
    worker, now = people.engaged, 0.05 * 59
    assert len(people.tracks) == 2 and worker.is_in_frame and worker.age == pytest.approx(0.0, abs=1e-9)
    assert worker.floor == pytest.approx([1.91, 0.0], abs=0.03)
    assert np.cos(worker.heading) == pytest.approx(-1.0, abs=1e-2)
    assert worker.velocity == pytest.approx([-0.2, 0.0], abs=0.05)
    assert worker.stature[0] == pytest.approx(1.75, abs=0.1) and worker.stature[1] >= 0.0
    assert people.body.id == worker.id and np.array_equal(people.body.joints, walking.joints, equal_nan=True)
    assert worker.body.seen and worker.measured.joints == pytest.approx(walking.joints, nan_ok=True)
    assert [body.joints[8].tolist() for body in people.others] == [other.joints[8].tolist()]
    assert np.cos(people.heading_near(walking, now)) == pytest.approx(-1.0, abs=1e-2)
    assert people.heading_near(Body.standing(Person(1.7), [9.0, 9.0], 0.0), now) is None
    with pytest.raises(ValueError, match="time"):
        people.update(1.0, [walking])


def depth_of(body, camera):
    """A depth image of a person as discs around their joints, 0.03 m before these."""
    depth = np.zeros((480, 640))
    rows, columns = np.mgrid[:480, :640]
    for (x, y), point in zip(camera.project(body.joints), body.joints):
        if not np.isnan(x):
            depth[(columns - x) ** 2 + (rows - y) ** 2 < 400] = point[0] - 0.03
    return depth


def test_from_image_to_command():
    lifter, people = Lifter(AHEAD), People()
    controller = Controller.moca(ErgonomicsMap(Person(1.75), spacing=0.1))
    truth = Body.standing(Person(1.75), [2.2, 0.0], np.pi)
    image, depth, q = seen_by(AHEAD, truth), depth_of(truth, AHEAD), controller.position
    for tick in range(1000):
        time = 1e-3 * tick
        if tick % 50 == 0:
            body = lifter.lift(image, depth, heading=lambda body: people.heading_near(body, time))
            people.update(time, [body])
            controller.observe(Scene(people.body, others=people.others, time=time, action="Using The Drill"))
        command = controller.step(q, 1e-3)
        q = q + command.velocity * 1e-3
    assert command.safety == "normal" and command.together
    assert controller.person["floor"] == pytest.approx([2.2, 0.0], abs=0.1)
    assert np.cos(controller.person["heading"]) == pytest.approx(-1.0, abs=0.02)


def test_the_nearest_person_of_a_depth_image():
    depth = np.zeros((480, 640), np.uint16)
    depth[60:440, 280:360] = 2500
    left, top, width, height = nearest_person(AHEAD, depth)
    assert abs(left - 280) < 20 and abs(top - 60) < 20 and abs(width - 80) < 40 and abs(height - 380) < 40
    assert nearest_person(AHEAD, np.zeros((480, 640))) is None


def test_the_example_ends_with_a_command(tmp_path):
    (tmp_path / "pose_solution_packed_assets.data").write_bytes(DETECTOR.read_bytes())
    (tmp_path / "pose_landmark_full.tflite").write_bytes(LANDMARKS.read_bytes())
    # Everywhere in a white image, the networks of blaze_pose.py find a person.
    (tmp_path / "colour.png").write_bytes(png(np.full((480, 640, 3), 255, np.uint8)))
    (tmp_path / "depth.png").write_bytes(png(np.full((480, 640), 2500, np.uint16)))
    lines = run_example("body_from_image", tmp_path, tmp_path / "colour.png", tmp_path / "depth.png").splitlines()
    assert lines[0].startswith("person 0: ") and int(lines[0].split()[2]) == len(lines) - 3 > 10
    # Their landmarks are on a line.
    assert lines[-2].startswith("no data: frame of an impossible body") and lines[-1].startswith("the robot: ")


def test_the_example_says_where_networks_are(tmp_path):
    with pytest.raises(subprocess.CalledProcessError) as caught:
        run_example("body_from_image", tmp_path, "colour.png", "depth.png")
    assert "npm pack @mediapipe/pose" in caught.value.stderr
