"""Bad input of any kind gives an exception that says what is wrong."""

import numpy as np
import pytest
from support import PANDA

import ahqp
from ahqp import ergo, whole_body

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


@pytest.mark.parametrize("call, kind, text", CASES)
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
