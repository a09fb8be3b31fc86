"""Problems, solutions and proofs."""

import copy
import threading

import numpy as np
import pytest
from support import lexicographic, problem

import ahqp


def build(levels, **options):
    hierarchy = ahqp.Hierarchy(np.shape(levels[0][0])[1])
    for matrix, lower, upper in levels:
        hierarchy.push(matrix, lower, upper, **options)
    return hierarchy


@pytest.mark.parametrize("seed", range(20))
def test_equalities_are_what_projections_give(seed):
    """Solution of equalities alone, level by level: numpy's pseudoinverse is the oracle."""
    rng = np.random.default_rng(seed)
    levels = [(rng.normal(size=(m, 8)), rng.normal(size=m)) for m in (3, 2, 2)]
    x, free = np.zeros(8), np.eye(8)
    for matrix, target in levels:
        x = x + np.linalg.pinv(matrix @ free) @ (target - matrix @ x)
        free = free @ (np.eye(8) - np.linalg.pinv(matrix @ free) @ (matrix @ free))
    hierarchy = build([(matrix, target, target) for matrix, target in levels])
    solution = ahqp.Solver(hierarchy).solve(hierarchy)
    assert solution.x == pytest.approx(x, abs=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_solutions_are_proved_and_violations_are_what_numpy_says(seed):
    levels = problem(np.random.default_rng(seed))
    hierarchy = build(levels)
    solver = ahqp.Solver(hierarchy)
    solution = solver.solve(hierarchy)
    assert solution.status == "solved" and solution.iterations > 0 and solution.time > 0.0
    assert solution.violations == pytest.approx(lexicographic(levels, solution.x), abs=1e-12)
    assert solver.certificate(hierarchy).residuals(hierarchy, solution.x).worst < 1e-9
    # Stationarity of the first level, from its multipliers.
    matrix, lower, upper = levels[0]
    value = matrix @ solution.x
    violation = np.maximum(value - upper, 0.0) + np.minimum(value - lower, 0.0)
    assert solution.multipliers[0] == [] and np.abs(matrix.T @ violation).max() < 1e-9


def test_the_layout_of_daqp_is_the_same_problem():
    levels = problem(np.random.default_rng(3))
    hierarchy = build(levels)
    hierarchy.set_bounds(np.full(6, -1.0), np.full(6, 1.0))
    stacked = [np.concatenate([level[part] for level in levels]) for part in range(3)]
    breaks = np.cumsum([len(level[1]) for level in levels])
    solution = ahqp.solve(*stacked, breaks, lb=np.full(6, -1.0), ub=np.full(6, 1.0))
    assert solution.x.tolist() == ahqp.Solver(hierarchy).solve(hierarchy).x.tolist()


@pytest.mark.parametrize(
    "change",
    [
        np.asfortranarray,
        lambda a: np.repeat(np.repeat(a, 2, axis=0), 3, axis=-1)[::2, ::3] if a.ndim == 2 else a,
        lambda a: a[::-1].copy()[::-1],
        lambda a: a.tolist(),
        lambda a: a.astype(">f8"),
        lambda a: np.frombuffer(b"x" + a.tobytes(), dtype="u1")[1:].view("f8").reshape(a.shape),
        lambda a: np.asarray(a, order="F").copy().view(),
    ],
)
def test_layouts_do_not_matter(change):
    levels = problem(np.random.default_rng(5))
    one, other = build(levels), build([tuple(change(part) for part in level) for level in levels])
    assert ahqp.Solver(one).solve(one).x.tolist() == ahqp.Solver(other).solve(other).x.tolist()


def test_read_only_integers_and_narrow_floats_are_taken():
    hierarchy = ahqp.Hierarchy(2)
    matrix = np.eye(2, dtype=np.float32)
    matrix.flags.writeable = False
    hierarchy.push(matrix, np.array([1, 2], dtype=np.uint8), [1, 2])
    assert ahqp.Solver(hierarchy).solve(hierarchy).x == pytest.approx([1.0, 2.0], abs=1e-12)


def test_data_are_rewritten_and_the_input_is_not_kept():
    target = np.array([1.0, 2.0])
    hierarchy = ahqp.Hierarchy(2)
    level = hierarchy.push(np.eye(2), target, target)
    solver = ahqp.Solver(hierarchy)
    target[:] = 7.0
    assert solver.solve(hierarchy).x == pytest.approx([1.0, 2.0], abs=1e-12)
    hierarchy.update(level, lower=target, upper=target, A=2.0 * np.eye(2), weights=[1.0, 4.0])
    assert solver.solve(hierarchy).x == pytest.approx([3.5, 3.5], abs=1e-12)


def test_quadratics_and_hard_rows():
    hierarchy = ahqp.Hierarchy(2)
    hierarchy.push([[1.0, 0.0]], upper=[0.5], hard=True)
    level = hierarchy.push_quadratic(np.eye(2), [-1.0, -2.0], name="quadratic")
    solver = ahqp.Solver(hierarchy)
    assert solver.solve(hierarchy).x == pytest.approx([0.5, 2.0], abs=1e-12)
    hierarchy.update_quadratic(level, H=2.0 * np.eye(2), g=[0.0, -2.0])
    assert solver.solve(hierarchy).x == pytest.approx([0.0, 1.0], abs=1e-12)
    assert hierarchy.names == [None, "quadratic"] and len(hierarchy) == 2


def test_a_budget_ends_a_solve_and_says_so():
    hierarchy = build(problem(np.random.default_rng(1)))
    solver = ahqp.Solver(hierarchy, warm_start=False)
    solution = solver.solve(hierarchy, iterations=1)
    assert solution.status == "iteration_limit" and solution.best.shape == (6,)
    with pytest.raises(ahqp.UnfinishedError, match="iterations ran out"):
        _ = solution.x
    assert solver.solve(hierarchy, time=10.0).status == "solved"
    with pytest.raises(ValueError, match="time is -1"):
        solver.solve(hierarchy, time=-1.0)


def test_a_conflict_is_named():
    hierarchy = ahqp.Hierarchy(1)
    hierarchy.set_bounds([0.0], [1.0])
    hierarchy.name_variables(["elbow"])
    hierarchy.push([[1.0]], lower=[2.0], hard=True, name="posture")
    with pytest.raises(ahqp.InfeasibleError, match="posture") as caught:
        ahqp.Solver(hierarchy).solve(hierarchy)
    rows = caught.value.conflict
    assert [str(row) for row in rows] == [
        'constraint row 0 of level 0 "posture"',
        'the bounds of variable 0 "elbow"',
    ]
    assert [(row.kind, row.level, row.index) for row in rows] == [
        ("constraint", 0, 0),
        ("bound", None, 0),
    ]


def test_stale_multipliers_are_refused():
    hierarchy = build(problem(np.random.default_rng(2)))
    solver = ahqp.Solver(hierarchy)
    first = solver.solve(hierarchy)
    assert len(first.multipliers) == 4
    solver.solve(hierarchy)
    with pytest.raises(ValueError, match="solved again"):
        _ = first.multipliers
    last = solver.solve(hierarchy)
    hierarchy.update(0, lower=np.zeros(3), upper=np.zeros(3))
    with pytest.raises(ahqp.Error, match="has changed since"):
        _ = last.multipliers
    with pytest.raises(ValueError, match="has changed"):
        _ = last.violations


def test_copies_are_apart():
    hierarchy = ahqp.Hierarchy(1)
    level = hierarchy.push([[1.0]], [1.0], [1.0])
    other = copy.copy(hierarchy)
    other.update(level, lower=[2.0], upper=[2.0])
    solver = ahqp.Solver(hierarchy)
    twin = copy.copy(solver)
    answers = [solver.solve(hierarchy).x[0], twin.solve(other).x[0]]
    assert answers == pytest.approx([1.0, 2.0], abs=1e-12)


def test_threads_solve_at_the_same_time_and_a_shared_solver_is_refused():
    rng = np.random.default_rng(0)
    levels = [(a := rng.normal(size=(60, 120)), a[:, 0], a[:, 0]) for _ in range(2)]
    hierarchy = build(levels)
    shared = ahqp.Solver(hierarchy, warm_start=False)
    expected = shared.solve(hierarchy).x
    refused, wrong = [], []

    def solve(solver, problem):
        for _ in range(20):
            try:
                if solver.solve(problem).x.tolist() != expected.tolist():
                    wrong.append("another answer")
            except RuntimeError as error:
                refused.append(str(error))

    def run(pairs):
        threads = [threading.Thread(target=solve, args=pair) for pair in pairs]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    run([(copy.copy(shared), copy.copy(hierarchy)) for _ in range(4)])
    assert not refused and not wrong
    run([(shared, hierarchy) for _ in range(4)])
    assert not wrong
    assert refused and "another thread is using this solver" in refused[0]


def test_limits_are_those_of_one_joint_each():
    limits = ahqp.Limits([-1.0, -2.0], [1.0, 2.0], [2.0, 1.0], [10.0, 5.0], jerk=[np.inf, 1e3])
    lower, upper = limits.velocity_interval([0.0, 2.0], [0.0, 0.0], 1e-3)
    # At rest in the middle: what the acceleration gives in a tick. At its limit: not further.
    assert [lower[0], upper[0]] == pytest.approx([-0.01, 0.01], abs=1e-12)
    assert upper[1] <= 1e-12 and lower[1] < 0.0
    assert limits.admits([0.0, 3.0], [0.0, 0.0]) == [True, False]
