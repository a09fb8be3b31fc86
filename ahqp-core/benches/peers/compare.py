"""Solves sets of hierarchical problems with several solvers and prints a table; see README.md."""

import argparse
import pathlib
import re
import subprocess
import tempfile
import time
import warnings

import daqp
import numpy as np
import qpsolvers

INFINITE = 1e30
RIGHT = 1e-6
EQUAL = 1e-10


class Level:
    """Rows lower ≤ A x ≤ upper; `bounds` is true if they are bounds of variables."""

    def __init__(self, bounds, hard, matrix, lower, upper):
        self.bounds, self.hard = bounds, hard
        self.matrix, self.lower, self.upper = matrix, lower, upper

    def violation(self, x):
        value = self.matrix @ x
        return np.linalg.norm(value - np.clip(value, self.lower, self.upper))


class Problem:
    def __init__(self, text, variables, levels):
        self.text, self.variables, self.levels = text, variables, levels

    def violations(self, x):
        return np.array([level.violation(x) for level in self.levels])

    def shape(self):
        return self.variables, [(level.bounds, level.hard, len(level.lower)) for level in self.levels]


def read(path, limit):
    """The first problems of a set."""
    lines = iter(pathlib.Path(path).read_text().splitlines())
    count = min(int(next(lines).split()[2]), limit)
    problems = []
    for _ in range(count):
        text = [next(lines)]
        _, _, _, variables, levels = text[0].split()
        variables = int(variables)
        problem = Problem(text, variables, [])
        for _ in range(int(levels)):
            text.append(next(lines))
            _, kind, hard, rows = text[-1].split()
            block = [next(lines) for _ in range(int(rows))]
            text += block
            width = 3 if kind == "B" else variables + 2
            data = np.array([line.split() for line in block], dtype=float).reshape(-1, width)
            matrix = data[:, :-2]
            if kind == "B":
                matrix = np.eye(variables)[data[:, 0].astype(int)]
            matrix = np.ascontiguousarray(matrix)
            problem.levels.append(
                Level(kind == "B", hard == "1", matrix, data[:, -2].copy(), data[:, -1].copy())
            )
        problems.append(problem)
    return problems


class Result:
    """Solutions, None if there is none, with median and 99th percentile of the times in µs."""

    def __init__(self, solutions, median, p99):
        self.solutions, self.median, self.p99 = solutions, median, p99

    @classmethod
    def of_times(cls, solutions, times):
        return cls(solutions, np.median(times), np.percentile(times, 99))


def program(binary, problems, *options):
    """The result of a program that takes a file and prints what `hqp` prints."""
    with tempfile.NamedTemporaryFile("w", suffix=".hqp") as file:
        file.write(f"hqpset compared {len(problems)}\n")
        for problem in problems:
            file.write("\n".join(problem.text) + "\n")
        file.flush()
        command = [binary, file.name, "--repeat", "3", *options]
        result = subprocess.run(command, capture_output=True, text=True, check=True)
    solutions = []
    for line in result.stdout.splitlines():
        _, status, _, *x = line.split()
        solutions.append(np.array(x, dtype=float) if status == "0" else None)
    times = dict(re.findall(r"(\w+)=([\d.]+)", result.stderr.splitlines()[-1]))
    return Result(solutions, float(times["median_us"]), float(times["p99_us"]))


def daqp_hierarchy(problems, start):
    """DAQP's hierarchical mode; `start` is the part of the last solution that it starts from."""
    solutions, times, before = [], [], {}
    for problem in problems:
        first, rest = problem.levels[0], problem.levels[1:]
        # DAQP only supports bounds of the first variables, in order.
        simple = first.bounds and np.array_equal(
            first.matrix, np.eye(len(first.lower), problem.variables)
        )
        matrix = np.vstack([level.matrix for level in (rest if simple else problem.levels)])
        lower = np.concatenate([level.lower for level in problem.levels])
        upper = np.concatenate([level.upper for level in problem.levels])
        ends = np.cumsum([len(level.lower) for level in problem.levels]).astype(np.int32)
        sense = np.zeros(len(lower), dtype=np.int32)
        x, _, flag, info = daqp.solve(
            None, None, matrix, upper, lower, sense, break_points=ends, **before
        )
        times.append(1e6 * (info["setup_time"] + info["solve_time"]))
        solutions.append(x.copy() if flag in (1, 2) else None)
        if start and flag in (1, 2):
            before = {start: {"primal_start": x, "dual_start": info["lam"]}[start].copy()}
    return Result.of_times(solutions, times)


def cascade(problems, solver):
    """One ordinary quadratic program per level, with the levels above stacked as equalities."""
    solutions, times = [], []
    for problem in problems:
        x, took = np.zeros(problem.variables), 0.0
        held = Held(problem.variables)
        for level in problem.levels:
            if level.hard:
                held.inequalities.append((level.matrix, level.lower, level.upper))
                continue
            x, seconds = held.minimise(level, solver)
            took += seconds
            if x is None:
                break
            held.hold(level, x)
        solutions.append(x)
        times.append(1e6 * took)
    return Result.of_times(solutions, times)


class Held:
    """The constraints that all further levels must keep."""

    def __init__(self, variables):
        self.variables = variables
        self.equalities = (np.zeros((0, variables)), np.zeros(0))
        self.inequalities = []

    def minimise(self, level, solver):
        """min ½‖w‖² with lower ≤ A x − w ≤ upper, a little of ‖x‖² added; w of equalities is
        A x − b and needs no variable."""
        equal = level.lower == level.upper
        a, b = level.matrix[equal], level.lower[equal]
        soft, n = int((~equal).sum()), self.variables
        hessian = np.zeros((n + soft, n + soft))
        hessian[:n, :n] = a.T @ a + 1e-9 * np.eye(n)
        hessian[n:, n:] = np.eye(soft)
        gradient = np.concatenate([-a.T @ b, np.zeros(soft)])
        rows = [(level.matrix[~equal], level.lower[~equal], level.upper[~equal], -np.eye(soft))]
        rows += [(m, l, u, np.zeros((len(l), soft))) for m, l, u in self.inequalities]
        sides = []
        for matrix, lower, upper, slack in rows:
            wide = np.hstack([matrix, slack])
            sides.append((wide[upper < INFINITE], upper[upper < INFINITE]))
            sides.append((-wide[lower > -INFINITE], -lower[lower > -INFINITE]))
        g, h = (np.concatenate(parts) for parts in zip(*sides))
        matrix, value = self.equalities
        stacked = np.hstack([matrix, np.zeros((len(value), soft))])
        problem = qpsolvers.Problem(hessian, gradient, g, h, stacked, value)
        start = time.perf_counter()
        try:
            solution = qpsolvers.solve_problem(problem, solver=solver)
        except Exception:  # An exception counts as a failure.
            return None, time.perf_counter() - start
        seconds = time.perf_counter() - start
        return (solution.x[:n] if solution.found else None), seconds

    def hold(self, level, x):
        """The level's violated rows and equalities keep their values, the others their ranges."""
        value = level.matrix @ x
        off = np.abs(value - np.clip(value, level.lower, level.upper)) > 1e-7
        fixed = (level.lower == level.upper) | off
        self.inequalities.append((level.matrix[~fixed], level.lower[~fixed], level.upper[~fixed]))
        matrix = np.vstack([self.equalities[0], level.matrix[fixed]])
        value = np.concatenate([self.equalities[1], value[fixed]])
        # Quadratic solvers need independent equalities.
        kept, basis = [], np.zeros((0, self.variables))
        for i, row in enumerate(matrix):
            rest = row - basis.T @ (basis @ row)
            rest -= basis.T @ (basis @ rest)
            if np.linalg.norm(rest) > 1e-9 * max(np.linalg.norm(row), 1e-300):
                kept.append(i)
                basis = np.vstack([basis, rest / np.linalg.norm(rest)])
        self.equalities = (matrix[kept], value[kept])


def share_right(problems, results):
    """Share, for each solver, of the problems on which all its level residuals are right."""
    right = {name: 0 for name in results}
    for index, problem in enumerate(problems):
        found = {
            name: problem.violations(result.solutions[index])
            for name, result in results.items()
            if result.solutions[index] is not None
        }
        best = lexicographic_least(list(found.values()))
        for name, values in found.items():
            right[name] += bool(np.all(np.abs(values - best) <= RIGHT * (1.0 + best)))
    return {name: count / len(problems) for name, count in right.items()}


def lexicographic_least(candidates):
    """The residuals that are least level by level. A solver that violates one level a little more
    gains in the next, so the tolerance here is finer than that for correct results."""
    for level in range(len(candidates[0]) if candidates else 0):
        best = min(values[level] for values in candidates)
        limit = best + EQUAL * (1.0 + best)
        candidates = [values for values in candidates if values[level] <= limit]
    return candidates[0] if candidates else None


def fastest(results):
    """The result with the least median."""
    return min(results, key=lambda result: result.median)


def hierarchical_solvers(problems, options):
    """Results of each hierarchical solver, by name and kind of start."""
    runs = {("ahqp-core", "cold"): lambda: program(options.hqp, problems)}
    runs["DAQP", "cold"] = lambda: daqp_hierarchy(problems, None)
    if options.lexls:
        runs["LexLS", "cold"] = lambda: program(options.lexls, problems)
    # Problems of different shapes allow no warm start.
    if any(problem.shape() != problems[0].shape() for problem in problems):
        return runs
    runs["ahqp-core", "warm"] = lambda: program(options.hqp, problems, "--warm")
    runs["DAQP", "warm"] = lambda: fastest(
        daqp_hierarchy(problems, start) for start in ("primal_start", "dual_start")
    )
    if options.lexls:
        runs["LexLS", "warm"] = lambda: fastest(
            program(options.lexls, problems, "--warm", *point) for point in ((), ("--point",))
        )
    return runs


def compare(path, options):
    """Prints the results of one set; returns those of the hierarchical solvers."""
    problems = read(path, options.limit)
    name = pathlib.Path(path).stem
    print(f"\n{name}: {len(problems)} problems", flush=True)
    if not problems:
        return name, {}
    results = {}
    # Several rounds in turn, because a shared machine may be slow for seconds.
    for _ in range(options.rounds):
        for key, run in hierarchical_solvers(problems, options).items():
            result = run()
            results[key] = fastest([result, results.get(key, result)])
    rows = dict(results)
    if not options.no_cascade:
        for solver in ("quadprog", "piqp", "proxqp", "clarabel"):
            if solver in qpsolvers.available_solvers:
                rows[f"cascade, {solver}", "cold"] = cascade(problems, solver)
    right = share_right(problems, rows)
    print(f"{'':22}{'median µs':>12}{'p99 µs':>12}{'ratio':>8}{'right':>8}{'failed':>8}")
    for (solver, start), result in sorted(rows.items(), key=lambda row: row[0][1], reverse=True):
        failed = sum(x is None for x in result.solutions)
        ratio = result.median / rows["ahqp-core", start].median
        print(
            f"{solver + ' ' + start:22}{result.median:12.2f}{result.p99:12.2f}{ratio:8.2f}"
            f"{right[solver, start]:8.1%}{failed:8}"
        )
    return name, results


def summarise(compared):
    """Prints a line for each set and kind of start: ahqp-core, and the ratio to each other solver."""
    others = [name for name in ("DAQP", "LexLS") if any((name, "cold") in r for _, r in compared)]
    print("\nmedian and p99 in µs; ratio: the other's median over that of ahqp-core")
    heads = ["set", "start", "ahqp-core", "p99", "p99/median"]
    for other in others:
        heads += [other, "p99", "ratio"]
    lines = []
    for name, results in compared:
        for start in ("warm", "cold"):
            if ("ahqp-core", start) not in results:
                continue
            ours = results["ahqp-core", start]
            cells = [f"{ours.median:.2f}", f"{ours.p99:.2f}", f"{ours.p99 / ours.median:.2f}"]
            for other in others:
                theirs = results[other, start]
                ratio = theirs.median / ours.median
                cells += [f"{theirs.median:.2f}", f"{theirs.p99:.2f}", f"{ratio:.2f}"]
            lines.append([name, start, *cells])
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    for line in lines:
        print("| " + " | ".join(line) + " |")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hqp", required=True, help="the `hqp` binary")
    parser.add_argument("--lexls", help="the `lexls_hqp` binary; see lexls/README.md")
    parser.add_argument("--limit", type=int, default=400, help="most problems of a set")
    parser.add_argument("--rounds", type=int, default=3, help="how often each solver runs")
    parser.add_argument("--no-cascade", action="store_true", help="leave the cascades out")
    parser.add_argument("sets", nargs="+")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    summarise([compare(path, options) for path in options.sets])


if __name__ == "__main__":
    main()
