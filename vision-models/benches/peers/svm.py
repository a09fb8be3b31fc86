"""Trains the linear SVM and scikit-learn's LinearSVC on the same features, in turns.

Needs numpy and scikit-learn:
    cargo build --release -p vision-models --example train_svm
    python vision-models/benches/peers/svm.py target/release/examples/train_svm

The first set has the size of the paper's training set: 1,400 images of 2,048 features. For each solver: seconds
(median of the rounds), and by how much its objective is above the best that is known. LinearSVC runs with its
default tolerance and with one that brings it near the optimum.
"""
import argparse
import subprocess
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from sklearn.svm import LinearSVC

warnings.filterwarnings("ignore")
parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("program")
parser.add_argument("--rounds", type=int, default=3)
parser.add_argument("--sets", nargs="*", default=None)
arguments = parser.parse_args()


def features_of_network(random):
    """Features like a ResNet's average pool: not negative and sparse. Classes overlap."""
    labels = (np.arange(1400) % 2).astype(np.uint8)
    directions = random.normal(size=(40, 2048))
    latent = random.normal(size=(1400, 40))
    latent[:, 0] += 1.0 * labels
    points = latent @ directions / np.sqrt(40) + random.normal(size=(1400, 2048)) * 0.5
    return np.maximum(points, 0).astype(np.float32) * 0.5, labels


def inseparable(samples, features):
    def make(random):
        labels = (np.arange(samples) % 2).astype(np.uint8)
        points = random.normal(size=(samples, features)) + 0.3 * labels[:, None] / np.sqrt(features)
        return points.astype(np.float32), labels

    return make


sets = {
    "1400x2048": features_of_network,
    "20000x10": inseparable(20_000, 10),
    "200000x10": inseparable(200_000, 10),
    "20000x300": inseparable(20_000, 300),
}


def objective(points, labels, loss, weights, bias):
    sides = np.where(labels == 1, 1.0, -1.0)
    short = np.maximum(0, 1 - sides * (points.astype(float) @ weights + bias))
    return 0.5 * (weights @ weights + bias * bias) + np.sum(short if loss == "hinge" else short**2)


def ours(folder, features, loss, tolerance):
    command = [arguments.program, folder / "points", folder / "labels", str(features), loss, "1", "1", str(tolerance)]
    seconds, value, gap, steps, converged = subprocess.check_output(command, text=True).split()
    return float(seconds), float(value), f"gap {float(gap):.1e}, {steps} steps, converged {converged}"


def theirs(points, labels, loss, tolerance, most):
    # In double precision, as in its training, so that no conversion is timed.
    points = points.astype(float)
    svm = LinearSVC(loss=loss, C=1.0, tol=tolerance, max_iter=most, dual=True if loss == "hinge" else "auto")
    start = time.perf_counter()
    svm.fit(points, labels)
    seconds = time.perf_counter() - start
    value = objective(points, labels, loss, svm.coef_[0], svm.intercept_[0])
    return seconds, value, f"{svm.n_iter_} epochs"


print("| set | loss | solver | seconds | above the best | |\n|---|---|---|---|---|---|")
for name, make in sets.items():
    if arguments.sets and name not in arguments.sets:
        continue
    points, labels = make(np.random.default_rng(1))
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        points.tofile(folder / "points")
        labels.tofile(folder / "labels")
        for loss in ["hinge", "squared_hinge"]:
            solvers = {
                "ours, gap 1e-6": lambda: ours(folder, points.shape[1], loss, 1e-6),
                "ours, gap 1e-9": lambda: ours(folder, points.shape[1], loss, 1e-9),
                "LinearSVC": lambda: theirs(points, labels, loss, 1e-4, 1000),
                "LinearSVC, tol 1e-7": lambda: theirs(points, labels, loss, 1e-7, 20_000),
            }
            runs = {solver: [] for solver in solvers}
            for _ in range(arguments.rounds):
                for solver, run in solvers.items():
                    runs[solver].append(run())
            best = min(run[1] for all_runs in runs.values() for run in all_runs)
            for solver, all_runs in runs.items():
                seconds = np.median([run[0] for run in all_runs])
                above = max(run[1] for run in all_runs) / best - 1
                print(f"| {name} | {loss} | {solver} | {seconds:.3f} | {above:.1e} | {all_runs[0][2]} |", flush=True)
