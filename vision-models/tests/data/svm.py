"""Writes linear SVMs that scikit-learn and SciPy train.

Needs numpy, scipy and scikit-learn (written with scikit-learn 1.9):
    python svm.py
"""
import json

import numpy as np
from scipy.optimize import minimize
from sklearn.svm import SVC, LinearSVC

random = np.random.default_rng(6)


def dataset(samples, features, classes, spread):
    labels = np.arange(samples) % classes
    centres = random.normal(size=(classes, features))
    points = centres[labels] + spread * random.normal(size=(samples, features))
    return np.round(points.astype(np.float32), 3).astype(np.float32), labels


def free_squared_hinge(points, sides, costs):
    """The paper's L2-SVM by Newton's method on the primal problem, C of each sample; bias last."""
    extended = np.hstack([points.astype(float), np.ones((len(points), 1))])
    start = np.zeros(extended.shape[1])

    def objective(w):
        short = np.maximum(0, 1 - sides * (extended @ w))
        return 0.5 * w[:-1] @ w[:-1] + costs @ short**2

    def gradient(w):
        short = np.maximum(0, 1 - sides * (extended @ w))
        g = -2 * extended.T @ (costs * sides * short)
        g[:-1] += w[:-1]
        return g

    def hessian(w):
        active = 1 - sides * (extended @ w) > 0
        h = 2 * extended[active].T @ (costs[active, None] * extended[active])
        h[np.arange(len(w) - 1), np.arange(len(w) - 1)] += 1
        return h

    best = minimize(objective, start, jac=gradient, hess=hessian, method="trust-exact", options={"gtol": 1e-11, "maxiter": 1000})
    assert np.abs(gradient(best.x)).max() < 1e-8, best
    return best.x


cases = []
for samples, features, classes, spread, cost, weights in [
    (30, 4, 2, 0.7, 1.0, None),
    (60, 5, 2, 2.0, 0.1, None),
    (45, 6, 3, 1.0, 1.0, None),
    (20, 40, 2, 1.0, 1.0, None),
    (50, 5, 2, 2.0, 0.5, [0.4, 3.0]),
    (40, 6, 3, 1.5, 1.0, [0.5, 2.0, 1.0]),
]:
    points, labels = dataset(samples, features, classes, spread)
    of_samples = np.ones(samples) if weights is None else np.array(weights)[labels]
    machines = []
    positives = [1] if classes == 2 else range(classes)
    for loss in ["hinge", "squared_hinge"]:
        for scaling in [None, 1.0, 5.0]:
            planes = []
            for positive in positives:
                sides = np.where(labels == positive, 1.0, -1.0)
                if scaling is not None:
                    svm = LinearSVC(loss=loss, C=cost, intercept_scaling=scaling, tol=1e-9, max_iter=3_000_000, dual=True).fit(points.astype(float), sides, of_samples)
                    plane = [float(svm.intercept_[0]), *svm.coef_[0].tolist()]
                elif loss == "hinge":
                    svm = SVC(kernel="linear", C=cost, tol=1e-10).fit(points.astype(float), sides, of_samples)
                    plane = [float(svm.intercept_[0]), *svm.coef_[0].tolist()]
                else:
                    w = free_squared_hinge(points, sides, cost * of_samples)
                    plane = [float(w[-1]), *w[:-1].tolist()]
                planes.append(plane)
            machines.append({"loss": loss, "scaling": scaling, "planes": planes})
    cases.append({"cost": cost, "weights": weights, "classes": classes, "labels": labels.tolist(), "points": [[round(float(v), 3) for v in row] for row in points], "machines": machines})
json.dump(cases, open("svm.json", "w"), separators=(",", ":"))
