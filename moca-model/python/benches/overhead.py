"""Time of a call from Python beyond the solve in Rust: the problems of a set, warm, all in one run.

    python benches/overhead.py problems.hqp [rounds]
"""

import pathlib
import statistics
import sys
import time

import numpy as np

import ahqp

INFINITE = 1e30


def read(path):
    """Problems as lists of levels (kind, hard, A, lower, upper)."""
    tokens = iter(pathlib.Path(path).read_text().split())
    assert next(tokens) == "hqpset"
    next(tokens)
    problems = []
    for _ in range(int(next(tokens))):
        assert next(tokens) == "problem"
        next(tokens), next(tokens)
        n, count = int(next(tokens)), int(next(tokens))
        levels = []
        for _ in range(count):
            assert next(tokens) == "level"
            kind, hard, rows = next(tokens), int(next(tokens)), int(next(tokens))
            width = (1 if kind == "B" else n) + 2
            block = np.array([float(next(tokens)) for _ in range(rows * width)]).reshape(rows, width)
            matrix = np.eye(n)[block[:, 0].astype(int)] if kind == "B" else block[:, :n]
            bounds = block[:, -2:]
            bounds[bounds >= INFINITE], bounds[bounds <= -INFINITE] = np.inf, -np.inf
            levels.append((kind, hard, np.ascontiguousarray(matrix), bounds[:, 0].copy(), bounds[:, 1].copy()))
        problems.append((n, levels))
    return problems


def hierarchies(problems):
    """One hierarchy a problem; hard bounds of all variables are bounds of the hierarchy."""
    for n, levels in problems:
        hierarchy = ahqp.Hierarchy(n)
        for kind, hard, matrix, lower, upper in levels:
            if kind == "B" and hard and np.array_equal(matrix, np.eye(n)):
                hierarchy.set_bounds(lower, upper)
            else:
                hierarchy.push(matrix, lower, upper, hard=bool(hard))
        yield hierarchy


def overhead(problems, rounds):
    """Medians over a warm pass of the set, of the round with the least overhead [µs]: what solves took within
    Rust, and what calls took beyond that, with the array of the result."""
    prepared = list(hierarchies(problems))
    found = []
    for _ in range(rounds):
        solver, inside, beyond = ahqp.Solver(prepared[0]), [], []
        for hierarchy in prepared:
            start = time.perf_counter_ns()
            solution = solver.solve(hierarchy)
            solution.x
            whole = time.perf_counter_ns() - start
            inside.append(1e6 * solution.time)
            beyond.append(1e-3 * whole - 1e6 * solution.time)
        found.append((statistics.median(beyond[1:]), statistics.median(inside[1:])))
    return min(found)


if __name__ == "__main__":
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 20
    beyond, inside = overhead(read(sys.argv[1]), rounds)
    print(f"solve {inside:.2f} µs, beyond it {beyond:.2f} µs")
