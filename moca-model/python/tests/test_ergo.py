"""Scores, people, maps and pictures."""

import json
import math

import numpy as np
import pytest
from support import WORKSPACE, run_example

from ahqp import ergo

GOLDEN = WORKSPACE / "ergo-map/tests/golden"


@pytest.fixture(scope="module")
def small_map():
    return ergo.ErgonomicsMap(ergo.Person(1.68), spacing=0.1)


def test_reba_of_the_printed_sheet():
    sheet = ergo.Worksheet(trunk_flexion=math.radians(70.0), load=12.0)
    reba = sheet.score()
    assert (reba.parts["trunk"], reba.parts["table_a"], reba.parts["score_a"]) == (4, 3, 5)
    assert 1 <= reba.score <= 15 and reba.action_level in range(5)
    assert sheet.load == 12.0 and sheet == ergo.Worksheet(trunk_flexion=math.radians(70.0), load=12.0)


def test_upright_standing_is_good_and_bending_is_not():
    upright, bent = ergo.Posture(elbow_flexion=1.4), ergo.Posture(trunk_flexion=1.5, neck_flexion=0.8)
    assert ergo.Reba.of_posture(upright).score == 1
    assert ergo.Rula.of_posture(upright).action_level == 1
    assert ergo.Reba.of_posture(bent).score > ergo.Reba.of_posture(upright).score
    assert ergo.ergonomics_score(bent) > ergo.ergonomics_score(upright, mode="faithful")


def test_rula_counts_its_boxes():
    plain = ergo.RulaWorksheet(trunk_flexion=0.5).score()
    ticked = ergo.RulaWorksheet(trunk_flexion=0.5, trunk_twisted=True, trunk_bent=True).score()
    assert ticked.parts["trunk"] == plain.parts["trunk"] + 2
    assert ergo.RulaWorksheet(load=12.0, load_pattern="shock").score().score >= plain.score


def test_people_reach_where_they_are_asked_to():
    person = ergo.Person(1.8, mass=80.0, segments={"upper_arm": 0.35})
    assert (person.stature, person.mass, person.segments["upper_arm"]) == (1.8, 80.0, 0.35)
    hand = [0.4, 0.2, 1.1]
    landmarks = person.landmarks_at(hand, side="left")
    assert landmarks["hand"] == pytest.approx(hand, abs=5e-4)
    reach = np.linalg.norm(landmarks["elbow"] - landmarks["shoulder"])
    assert reach == pytest.approx(0.35, abs=1e-9)
    assert person.posture_at(hand, side="left").elbow_flexion > 0.0
    assert 0.5 < person.elbow_height / person.stature < 0.7


def test_maps_are_what_their_nodes_say(small_map):
    positions, scores = small_map.nodes()
    assert positions.shape == (len(small_map), 3) and scores.shape == (len(small_map),)
    sampled = small_map.scores(positions)
    known = ~np.isnan(sampled)
    assert known.any() and sampled[known] == pytest.approx(scores[known], abs=1e-9)
    hand = [0.4, -0.2, 1.0]
    assert small_map.contains(hand) and not small_map.contains([3.0, 0.0, 0.0])
    score, gradient = small_map.sample(hand)
    moved = small_map.sample([0.4 + 1e-6, -0.2, 1.0])[0]
    assert (moved - score) / 1e-6 == pytest.approx(gradient[0], abs=1e-4)
    assert small_map.posture(hand).elbow_flexion > 0.0


def test_quadratics_are_convex_and_know_their_minimum(small_map):
    quadratic, report = small_map.fit(temperature=0.5)
    assert np.linalg.eigvalsh(quadratic.hessian).min() > 0.0
    best = quadratic.minimiser()
    assert quadratic.hessian @ best + quadratic.gradient == pytest.approx(np.zeros(3), abs=1e-9)
    assert quadratic.value(best) < quadratic.value(best + 0.1)
    assert quadratic.value(np.zeros(3)) == quadratic.constant
    assert report.samples >= 20 and report.rmse >= 0.0 and report.regret is not None
    assert report.eigenvalues == pytest.approx(np.linalg.eigvalsh(quadratic.hessian), abs=1e-9)


def test_maps_are_written_and_read(small_map, tmp_path):
    small_map.save(tmp_path / "one.map")
    read = ergo.ErgonomicsMap.load(tmp_path / "one.map")
    assert np.array_equal(read.nodes()[1], small_map.nodes()[1])
    assert (read.stature, read.side) == (1.68, "right")
    cut = (tmp_path / "one.map").read_bytes()[:-5]
    (tmp_path / "cut.map").write_bytes(cut)
    with pytest.raises(ValueError, match="not a usable"):
        ergo.ErgonomicsMap.load(tmp_path / "cut.map")


def test_pictures_are_drawn(small_map, tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("svg")
    axes = ergo.draw_map(small_map, resolution=0.05)
    ergo.draw_person(ergo.Person(1.68), [0.4, -0.2, 1.0], axes)
    axes.figure.savefig(tmp_path / "map.svg")
    assert (tmp_path / "map.svg").stat().st_size > 5000
    # A body of three chains, the hand, the floor.
    assert len(axes.lines) == 5


def test_the_example_prints_the_optimum():
    best, rmse = run_example("person_map").rsplit(" ", 1)
    assert len(json.loads(best)) == 3 and 0.0 < float(rmse) < 0.5
