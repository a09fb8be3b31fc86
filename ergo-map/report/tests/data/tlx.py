#!/usr/bin/env python3
"""Golden values for `tlx`, from NumPy, SciPy and statsmodels.

A hundred studies of two conditions; ratings are whole or quarters, so that differences tie in some
and vanish in some. SciPy's permutation method counts all signs of the ranks: it is exact with ties.
Run in this folder: python3 tlx.py. Writes tlx.jsonl, a study a line.
"""
import json

import numpy as np
from scipy.stats import PermutationMethod, rankdata, wilcoxon
from statsmodels.stats.multitest import multipletests

random = np.random.default_rng(7)


def tested(before, after):
    difference = after - before
    difference = difference[difference != 0]
    if difference.size < 2:  # SciPy rejects these.
        return {"p": 1.0, "effect": float(np.sign(difference).sum())}
    exact = PermutationMethod(n_resamples=2 ** (difference.size + 1))
    result = wilcoxon(difference, method=exact)
    ranks = rankdata(abs(difference))
    effect = float(np.sum(np.sign(difference) * ranks) / np.sum(ranks))
    assert min(ranks[difference > 0].sum(), ranks[difference < 0].sum()) == result.statistic
    return {"p": float(min(1.0, result.pvalue)), "effect": effect}


with open("tlx.jsonl", "w", encoding="utf-8") as file:
    for study in range(100):
        subjects = int(random.integers(2, 13))
        grid = (1, 4, 1)[study % 3]
        span = (20, 20, 4)[study % 3]
        before = random.integers(0, span * grid + 1, (6, subjects)) / grid
        shift = random.integers(-3, 4, (6, subjects)) + random.integers(-4, 5, (6, 1))
        after = np.clip(before + shift, 0, 20)
        tests = [tested(*pair) for pair in zip(before, after)]
        holm = multipletests([test["p"] for test in tests], method="holm")[1]
        quartiles = np.quantile(after, [0.25, 0.5, 0.75], axis=1).T
        weights = np.bincount(random.integers(0, 6, 15), minlength=6).clip(max=5)
        while weights.sum() < 15:
            weights[random.choice(np.flatnonzero(weights < 5))] += 1
        json.dump({
            "before": before.tolist(), "after": after.tolist(), "weights": weights.tolist(),
            "p": [test["p"] for test in tests], "effect": [test["effect"] for test in tests],
            "p_holm": holm.tolist(), "quartiles": quartiles.tolist(),
            "raw": after.mean(axis=0).tolist(),
            "weighted": (weights @ after / 15).tolist(),
        }, file)
        file.write("\n")
