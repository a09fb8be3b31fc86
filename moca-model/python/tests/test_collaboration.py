"""The controller with a person, its settings, faults and recordings."""

import json

import numpy as np
import pytest
from support import PANDA, WORKSPACE, run_example, run_rust_example

import ahqp
from ahqp.collaboration import Body, Controller, FrameError, GraspedObject, Recording, Scene
from ahqp.ergo import ErgonomicsMap, Person
from ahqp.whole_body import Data, Model

PERSON = Person(1.75)
PERIOD = 1e-3
FOLLOW = WORKSPACE / "examples/recordings/follow.jsonl"
PANDA_HOME = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]


@pytest.fixture(scope="module")
def ergonomics():
    return ErgonomicsMap(PERSON, spacing=0.1)


def run(controller, q, seconds, scene=lambda time: None):
    """Lets a robot that follows at once be moved, and returns all velocities, the last q, and the last command."""
    velocities = []
    for _ in range(round(seconds / PERIOD)):
        time = controller.time
        seen = scene(time) if round(time / PERIOD) % 50 == 0 else None
        if seen:
            controller.observe(seen)
        command = controller.step(q, PERIOD)
        velocities.append(command.velocity)
        q = q + command.velocity * PERIOD
    return np.array(velocities), q, command


def drilling(x=1.7, y=0.0):
    return Scene(Body.standing(PERSON, [x, y], np.pi), action="Using The Drill")


def test_the_example_ends_where_that_of_rust_does():
    assert run_example("meet_a_person") == run_rust_example("meet_a_person", "moca-model")


def test_the_tool_goes_to_a_person_who_works(ergonomics):
    controller = Controller.moca(ergonomics)
    controller.grasp(GraspedObject())
    limits = controller.model.limits
    velocities, _, command = run(controller, controller.position, 5.0, lambda _: drilling(2.2))
    assert command.phase == "working" and command.together and command.safety == "normal"
    assert command.activation > 0.0 and command.slack.shape == (6,)
    # The hand is in the work zone of a person of 1.75 m, who faces the robot from 2.2 m.
    place = np.diag([-1.0, -1.0, 1.0]) @ (controller.hand[:3, 3] - [2.2, 0.0, 0.0])
    assert np.all(place >= [0.2, -0.5, 0.7]) and np.all(place <= [0.75, 0.2, 1.6625])
    accelerations = np.diff(velocities, axis=0) / PERIOD
    assert np.all(np.abs(velocities) <= limits["velocity"] * (1 + 1e-9))
    assert np.all(np.abs(accelerations) <= limits["acceleration"] * (1 + 1e-6))
    assert controller.person["floor"] == pytest.approx([2.2, 0.0], abs=0.02)
    assert np.cos(controller.person["heading"]) == pytest.approx(-1.0, abs=1e-3)


def test_the_base_follows_a_person_who_leads(ergonomics):
    controller = Controller.moca(ergonomics)
    controller.grasp(GraspedObject())
    run(controller, controller.position, 1.5, lambda _: drilling())
    start, begun = controller.position, controller.time

    def leading(time):
        body = Body.standing(PERSON, [1.7 + 0.2 * (time - begun), 0.0], np.pi)
        return Scene(body, action="Move Backwards While Drilling")

    _, q, command = run(controller, start, 4.0, leading)
    assert command.phase == "walking" and command.base_drives
    assert q[0] - start[0] > 0.3  # of the 0.8 m that the person walks
    assert command.base_twist[0] > 0.1


def test_nobody_seen_stops_and_recovers_the_robot(ergonomics):
    controller = Controller.moca(ergonomics)
    _, q, command = run(controller, controller.position, 0.5, lambda _: drilling())
    assert command.safety == "normal" and command.cause is None
    _, q, command = run(controller, q, 1.4)
    assert command.safety == "protective_stop" and command.cause == "nobody seen for too long"
    assert np.abs(command.velocity).max() < 1e-3
    _, _, command = run(controller, q, 1.0, lambda _: drilling())
    assert command.safety == "normal"


def test_a_stop_waits_until_it_is_acknowledged(ergonomics):
    controller = Controller.moca(ergonomics)
    _, q, _ = run(controller, controller.position, 0.3, lambda _: drilling())
    controller.request_stop()
    _, q, command = run(controller, q, 1.0, lambda _: drilling())
    assert (command.safety, command.waits_for) == ("protective_stop", "stop requested")
    assert np.abs(command.velocity).max() < 1e-6
    controller.acknowledge()
    _, _, command = run(controller, q, 1.0, lambda _: drilling())
    assert command.safety == "normal" and command.waits_for is None


def test_bad_measurements_and_frames_are_faults(ergonomics):
    controller = Controller.moca(ergonomics)
    _, q, _ = run(controller, controller.position, 0.1, lambda _: drilling())
    command = controller.step(np.full(10, np.nan), PERIOD)
    assert command.fault == "bad measurement" and not command.is_optimal
    with pytest.raises(ahqp.Error, match="9 elements; the robot needs 10"):
        controller.step(q[:9], PERIOD)
    with pytest.raises(FrameError, match="future"):
        controller.observe(Scene(time=controller.time + 10.0))
    with pytest.raises(FrameError, match="millimetres"):
        controller.observe(Scene(Body({"neck": [1700.0, 0.0, 1400.0]})))
    assert "frame" in controller.step(q, PERIOD).fault
    # After a late step, frames are newer than it.
    late = controller.time + 0.03
    controller.observe(Scene(time=late - 0.01), now=late)


def test_crowds_stop_the_robot(ergonomics):
    controller = Controller.moca(ergonomics)
    crowd = [Body.standing(PERSON, [4.0, y], np.pi, id=number) for number, y in enumerate(range(-3, 3))]
    with pytest.raises(FrameError, match="people are in view"):
        controller.observe(Scene(others=crowd))
    assert controller.step(controller.position).safety == "protective_stop"


def test_a_bystander_is_kept_away_from(ergonomics):
    controller = Controller.moca(ergonomics)

    def approaching(time):
        return Scene(others=[Body.standing(PERSON, [2.0 - 1.1 * time, 0.1], np.pi)])

    _, _, command = run(controller, controller.position, 1.4, approaching)
    assert command.safety == "retreat" and command.cause == "person too close"
    assert controller.room < 0.0 and controller.person is None


def test_settings_replace_defaults_and_name_mistakes(ergonomics, tmp_path):
    slow = {"controller": {"desired": {"velocity": 0.05, "acceleration": 1}, "space": {"min": np.array([0.3, -0.4, 0.8])}}}
    settings = Controller.moca(ergonomics, settings=slow).settings["controller"]
    assert settings["desired"]["velocity"] == 0.05 and settings["desired"]["angular_velocity"] == 1.0
    assert settings["space"]["min"] == [0.3, -0.4, 0.8] and settings["horizon"] == 0.4
    file = tmp_path / "settings.toml"
    file.write_text('version = 1\n[controller]\ngoal = "least_motion"\nbase = "none"\n[topics]\nodometry = "/odom"\n')
    controller = Controller.moca(ergonomics, settings=file)
    assert controller.settings["controller"]["goal"] == "least_motion" and "base" not in controller.settings["controller"]
    assert "base" not in Controller.moca(ergonomics, settings={"controller": {"base": None}}).settings["controller"]
    controller.set_goal("ergonomics")
    assert controller.settings["controller"]["goal"] == "ergonomics"
    for wrong, message in [
        ({"controller": {"horizn": 1.0}}, "unknown field `horizn`"),
        ({"control": {}}, '"control"; its tables are "controller" and "torque"'),
        ({"controller": {"desired": {"velocity": -1.0}}}, "desired.velocity is -1"),
    ]:
        with pytest.raises(ValueError, match=message):
            Controller.moca(ergonomics, settings=wrong)
    with pytest.raises(FileNotFoundError):
        Controller.moca(ergonomics, settings=tmp_path / "none.toml")
    with pytest.raises(TypeError, match="a number, a word, a list or a dict"):
        Controller.moca(ergonomics, settings={"controller": {"horizon": object()}})


def test_a_torque_law_carries_the_arm(ergonomics):
    controller = Controller.moca(ergonomics, compensation="nothing")
    q, rest = controller.position, np.zeros(10)
    with pytest.raises(ValueError, match="velocity="):
        controller.step(q)
    command = controller.step(q, velocity=rest, torque=rest)
    data = Data(controller.model)
    data.update(q)
    assert command.torque[:3] == pytest.approx(0.0) and command.torque[3:] == pytest.approx(data.gravity()[3:], abs=0.5)
    for _ in range(300):
        command = controller.step(q, velocity=rest, torque=data.gravity() + 40.0 * np.eye(10)[6])
    assert np.linalg.norm(controller.external_force) > 30.0
    assert command.safety == "protective_stop"
    franka = Controller.moca(ergonomics, compensation="franka")
    assert franka.step(q, velocity=rest).torque == pytest.approx(0.0, abs=0.5)
    with pytest.raises(ValueError, match='"nothing", "franka"'):
        Controller.moca(ergonomics, compensation="gravity")


def test_an_arm_of_ones_own_holds_its_tool_for_somebody(ergonomics):
    model = Model.from_file(PANDA)
    bodies = [("panda_hand", [0.0, 0.0, 0.0], [0.0, 0.0, 0.1], 0.06), ("panda_link4", [0, 0, 0], [0, 0, 0.1], 0.06)]
    bodies += [("panda_link0", [0.0, 0.0, 0.0], [0.0, 0.0, 0.1], 0.1)]
    pairs = [("panda_hand", "panda_link0")]
    controller = Controller(model, PANDA_HOME, "panda_hand_tcp", ergonomics, bodies=bodies, own_pairs=pairs)
    assert controller.settings["controller"]["safety"]["own_pairs"] == [[0, 2]]
    controller.grasp(GraspedObject(mass=0.5))
    start = controller.hand[:3, 3]
    _, _, command = run(controller, controller.position, 3.0, lambda _: drilling(1.1))
    assert command.phase == "working" and np.linalg.norm(controller.hand[:3, 3] - start) > 0.05
    assert not command.base_twist.any()
    with pytest.raises(ValueError, match="own_pairs names link `hand`"):
        Controller(model, PANDA_HOME, "panda_hand_tcp", ergonomics, bodies=bodies, own_pairs=[("hand", "panda_link0")])
    with pytest.raises(ValueError, match="mecanum is for a model"):
        Controller(model, PANDA_HOME, "panda_hand_tcp", ergonomics, mecanum=(1.0, 0.4, 1.0))
    with pytest.raises(ahqp.Error, match="nose"):
        Controller(model, PANDA_HOME, "nose", ergonomics)
    with pytest.raises(TypeError, match="ahqp.ergo.Person"):
        Controller(model, PANDA_HOME, "panda_hand_tcp", 1.75)


def test_the_hand_is_behind_a_grasped_object(ergonomics):
    controller = Controller.moca(ergonomics)
    tool = controller.hand
    controller.grasp(GraspedObject(size=[0.1, 0.2, 0.1], mass=0.5, faces={"front": "smooth"}))
    # Half of the box in front of the tool, 0.05 m below the fingertips.
    run(controller, controller.position, 1.0)
    way = np.linalg.inv(tool) @ controller.hand
    assert way[:3, 3] == pytest.approx([0.05, 0.0, 0.05], abs=5e-3)
    held = controller.release()
    assert held.mass == 0.5 and held.faces == {"front": "smooth"} and held.size.tolist() == [0.1, 0.2, 0.1]
    assert held.pose[:3, 3].tolist() == [0.0, 0.0, 0.05] and controller.release() is None
    with pytest.raises(ahqp.Error, match="object.mass"):
        GraspedObject(mass=-1.0)
    with pytest.raises(ValueError, match='"front", "back"'):
        GraspedObject(faces={"middle": "smooth"})


def test_bodies_stand_where_they_are_put():
    body = Body.standing(PERSON, [2.0, 1.0], np.pi / 2, hand=[0.4, -0.2, 1.1], id=7)
    joints = dict(zip(Body.JOINTS, body.joints))
    marks = PERSON.landmarks_at([0.4, -0.2, 1.1])
    turned = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for joint, mark in [("right wrist", "wrist"), ("right elbow", "elbow"), ("left shoulder", "other_shoulder")]:
        assert joints[joint] == pytest.approx(turned @ marks[mark] + [2.0, 1.0, 0.0], abs=1e-9)
    # The other arm hangs: elbow and wrist are below the shoulder.
    assert joints["left wrist"][:2] == pytest.approx(joints["left shoulder"][:2]) and joints["left wrist"][2] < 1.0
    assert body.id == 7 and len(body.seen) == 16
    with pytest.raises(ahqp.Error, match="cannot be at"):
        Body.standing(PERSON, [0.0, 0.0], 0.0, hand=[2.0, 0.0, 1.0])


def test_bodies_keep_what_was_measured():
    joints, covariances = np.full((25, 3), np.nan), np.full((25, 3, 3), np.nan)
    joints[1], covariances[1] = [1.0, 2.0, 1.4], np.diag([1e-4, 2e-4, 3e-4])
    confidences = np.where(np.isnan(joints[:, 0]), np.nan, 0.7)
    body = Body(joints, confidences, covariances=covariances, id=3)
    assert body.seen == ["neck"] and body.joints[1].tolist() == [1.0, 2.0, 1.4]
    assert body.confidences[1] == 0.7 and np.isnan(body.confidences[0])
    assert np.array_equal(body.covariances, covariances, equal_nan=True)
    for wrong, message in [
        (lambda: Body(joints[:24]), r"\(24, 3\); it must be \(25, 3\)"),
        (lambda: Body({"knee": [0, 0, 0]}), '"knee" is no joint'),
        (lambda: Body(joints, 1.5), "probability"),
        (lambda: Scene(action="Juggling"), "Scene.ACTIONS"),
        (lambda: Scene(surface="rough"), '"smooth" or "drilled"'),
    ]:
        with pytest.raises(ValueError, match=message):
            wrong()


def test_recordings_come_back_as_they_were_written(tmp_path):
    recording = Recording.read(FOLLOW)
    frames = [json.loads(line) for line in FOLLOW.read_text().splitlines()[1:-1]]
    assert recording.is_complete and recording.stature == 1.75 and recording.rate == 20.0
    assert len(recording.scenes) == len(frames)
    for scene, frame in zip(recording.scenes, frames):
        assert scene.time == frame["time"]
        assert (scene.action is None) == (frame["action"] is None)
        if scene.body:
            seen = [joint for joint in frame["keypoints"] if joint]
            assert scene.body.joints[~np.isnan(scene.body.joints[:, 0])] == pytest.approx(np.array(seen)[:, :3])
    again = tmp_path / "again.jsonl"
    Recording(recording.scenes, stature=1.75).write(again)
    assert [scene.time for scene in Recording.read(again).scenes] == [frame["time"] for frame in frames]
    cut = tmp_path / "cut.jsonl"
    cut.write_text("\n".join(again.read_text().splitlines()[:10]) + "\n")
    with pytest.raises(ahqp.Error):
        Recording.read(cut)
    assert len(Recording.read(cut, partial=True).scenes) == 9
    with pytest.raises(ValueError, match="scene 0 has no time"):
        Recording([Scene()])
    with pytest.raises(FileNotFoundError):
        Recording.read(tmp_path / "none.jsonl")
