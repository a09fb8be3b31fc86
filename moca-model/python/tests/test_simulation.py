"""People who are led, and what a camera with noise sees of them."""

import numpy as np
import pytest

import ahqp
from ahqp.simulation import SimulatedPerson


def speeds(person, seconds, dt=0.01):
    """The greatest speed over the floor and of a joint, by differences of true places."""
    fastest = [0.0, 0.0]
    for _ in range(round(seconds / dt)):
        floor, joints = person.floor, person.body.joints
        person.advance(dt)
        moved = [np.linalg.norm(person.floor - floor), np.linalg.norm(person.body.joints - joints, axis=1).max()]
        fastest = [max(pair) for pair in zip(fastest, np.array(moved) / dt)]
    return fastest


def test_the_person_walks_where_told_and_stops():
    person = SimulatedPerson(1.8, [2.0, 0.0], np.pi)
    person.walk_to([2.0, 1.5], speed=0.6)
    on_floor, of_joints = speeds(person, 6.0)
    assert person.floor == pytest.approx([2.0, 1.5], abs=0.03)
    assert np.linalg.norm(person.velocity) < 0.02
    assert on_floor == pytest.approx(0.6, abs=0.01) and of_joints < 4.0
    assert np.cos(person.heading) == pytest.approx(-1.0, abs=1e-3) and person.time == pytest.approx(6.0)
    person.walk_along([1.0, 0.0], speed=0.4)
    person.advance(3.0)
    assert person.velocity == pytest.approx([0.4, 0.0], abs=1e-3)
    person.stand()
    person.advance(3.0)
    assert np.linalg.norm(person.velocity) < 0.02


def test_bending_lowers_head_and_hips():
    person = SimulatedPerson(1.75)
    names = person.body.JOINTS
    height = {name: person.body.joints[names.index(name), 2] for name in ("neck", "mid hip")}
    assert 1.3 < height["neck"] < 1.6
    person.bend(lean=0.6, squat=0.1)
    person.advance(3.0)
    bent = {name: person.body.joints[names.index(name), 2] for name in height}
    assert height["mid hip"] - bent["mid hip"] == pytest.approx(0.175, abs=0.01)
    assert height["neck"] - bent["neck"] > 0.2
    person.bend()
    person.advance(3.0)
    assert person.body.joints[names.index("neck"), 2] == pytest.approx(height["neck"], abs=1e-3)


def test_the_working_hand_is_at_the_object():
    person = SimulatedPerson(1.75, [1.5, 0.0], np.pi)
    person.use_tool("polisher")
    wrist = person.body.JOINTS.index("right wrist")
    for place in ([1.05, 0.1, 1.1], [1.1, 0.2, 1.3]):
        person.advance(4.0, object=place)
        assert np.linalg.norm(person.body.joints[wrist] - place) < 0.15
    assert person.action == "Using The Polisher"
    person.walk_along([1.0, 0.0], speed=0.3)
    person.advance(2.0)
    assert person.action == "Move Backwards While Polishing"


def test_the_camera_errs_by_its_noise_alone():
    def errors(noise):
        person = SimulatedPerson(1.75, noise=noise, drop=0.0, seed=3)
        seen = []
        for _ in range(100):
            person.advance(0.05)
            seen.append(person.look().body.joints - person.body.joints)
        return np.linalg.norm(seen, axis=2)

    # The camera is at (0.3, 1.8, 2.3). Across the ray it errs by 1.5 of 615 pixels, and along it by 4.2 mm at a metre.
    distances = np.linalg.norm(SimulatedPerson(1.75).body.joints - [0.3, 1.8, 2.3], axis=1)
    expected = np.sqrt(np.mean(3 * (1.5 / 615 * distances) ** 2 + (0.08 / (385 * 0.05) * distances**2) ** 2))
    root = np.sqrt(np.mean(errors(1.0) ** 2))
    assert root == pytest.approx(expected, rel=0.05)
    assert np.sqrt(np.mean(errors(2.0) ** 2)) == pytest.approx(2.0 * root, rel=1e-6)
    assert errors(0.0).max() < 1e-12


def test_frames_repeat_by_seed_and_are_lost_by_drop():
    def frames(seed, drop):
        person = SimulatedPerson(seed=seed, drop=drop, id=7)
        person.use_tool("drill")
        seen = []
        for _ in range(400):
            person.advance(0.05)
            seen.append(person.look())
        return seen

    seen = frames(1, 0.1)
    joints = [scene.body.joints if scene and scene.body else None for scene in seen]
    again = [scene.body.joints if scene and scene.body else None for scene in frames(1, 0.1)]
    assert all((a is None and b is None) or np.array_equal(a, b, equal_nan=True) for a, b in zip(joints, again))
    other = [scene.body.joints if scene and scene.body else None for scene in frames(2, 0.1)]
    assert any(a is not None and b is not None and not np.array_equal(a, b) for a, b in zip(joints, other))
    # A hundredth of the frames is lost, and a tenth of the joints.
    assert 0 < seen.count(None) < 20
    missing = np.mean([np.isnan(places[:, 0]).mean() for places in joints if places is not None])
    assert missing == pytest.approx(0.1, abs=0.02)
    assert all(scene is not None and scene.body for scene in frames(1, 0.0))
    first = next(scene for scene in seen if scene and scene.body)
    assert first.body.id == 7 and first.time == pytest.approx(0.05 * (1 + seen.index(first)))
    # The recogniser is late and sometimes wrong, but most of its frames have the true action.
    actions = [scene.action[0] for scene in seen if scene and scene.action]
    assert actions.count("Using The Drill") > 0.9 * len(actions) > 300


def test_others_are_in_the_frame():
    person, other = SimulatedPerson(drop=0.0), SimulatedPerson(floor=[4.0, 1.0], id=1)
    person.advance(0.05)
    scene = person.look([other.body])
    assert [body.id for body in scene.others] == [1]


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        (lambda: SimulatedPerson(3.0), "stature = 3: give 1 to 2.3 m"),
        (lambda: SimulatedPerson(floor=[1.0]), "floor"),
        (lambda: SimulatedPerson(heading=float("nan")), "heading"),
        (lambda: SimulatedPerson(noise=-1.0), "noise = -1: give 0 to 10"),
        (lambda: SimulatedPerson(drop=2.0), "drop = 2: give 0 to 1"),
        (lambda: SimulatedPerson().walk_to([1.0, 0.0], speed=5.0), "speed = 5: give 0.1 to 1.2 m/s"),
        (lambda: SimulatedPerson().walk_to([100.0, 0.0]), "way.to.x"),
        (lambda: SimulatedPerson().walk_along([0.0, 0.0]), "way.along"),
        (lambda: SimulatedPerson().bend(2.0), "lean = 2"),
        (lambda: SimulatedPerson().face("robot"), "\"way\" or \"object\""),
        (lambda: SimulatedPerson().use_tool("hammer"), "\"drill\", \"polisher\" or None"),
        (lambda: SimulatedPerson().advance(-1.0), "dt = -1"),
        (lambda: SimulatedPerson().advance(float("nan")), "dt = NaN"),
        (lambda: SimulatedPerson().advance(0.1, object=[0.0, 0.0]), "object"),
    ],
)
def test_what_nobody_can_do_is_refused(wrong, says):
    with pytest.raises(ValueError, match=says):
        wrong()
    assert issubclass(ahqp.Error, ValueError)
