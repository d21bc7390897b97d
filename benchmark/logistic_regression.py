# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Logistic regression with weighted samples, no weight of a feature below zero, and how good its probabilities are."""
import math

# A prior: weights are normally distributed, with this inverse variance per variance of the feature. Decides only what the
# samples leave open.
RIDGE = 0.3
MAX_STEPS = 100
CLOSE = 1e-10


class Sample:
    """Features, outcome (1 or 0), and how much it counts."""

    def __init__(self, features, outcome, weight=1.0):
        self.features = features
        self.outcome = outcome
        self.weight = weight


class Model:
    """A probability: the logistic function of a constant and the weighted sum of the features."""

    def __init__(self, constant, weights):
        self.constant = constant
        self.weights = weights

    def probability(self, features):
        return logistic(self.constant + sum(w * x for w, x in zip(self.weights, features)))


def logistic(evidence):
    return 1 / (1 + math.exp(-evidence)) if evidence >= 0 else math.exp(evidence) / (1 + math.exp(evidence))


def fit(samples):
    """The most probable model with no weight below zero: features whose weight would be are left out one by one, the
    worst first."""
    means, scales = spread(samples)
    rows = [Sample([1.0] + [(x - m) / s for x, m, s in zip(sample.features, means, scales)], sample.outcome,
                   sample.weight) for sample in samples]
    used = [k for k, scale in enumerate(scales) if scale < math.inf]
    while True:
        solution = maximize([Sample([row.features[0]] + [row.features[k + 1] for k in used], row.outcome, row.weight)
                             for row in rows], RIDGE)
        worst = min(range(len(used)), key=lambda i: solution[i + 1], default=None)
        if worst is None or solution[worst + 1] >= 0:
            break
        del used[worst]
    weights = [0.0] * len(means)
    for k, weight in zip(used, solution[1:]):
        weights[k] = weight / scales[k]
    return Model(solution[0] - sum(w * m for w, m in zip(weights, means)), weights)


def spread(samples):
    """Mean and standard deviation of each feature; infinite for one that is always the same, so that it is left out."""
    total = sum(sample.weight for sample in samples)
    means, scales = [], []
    for values in zip(*(sample.features for sample in samples)):
        mean = sum(sample.weight * x for sample, x in zip(samples, values)) / total
        variance = sum(sample.weight * (x - mean) ** 2 for sample, x in zip(samples, values)) / total
        means.append(mean)
        scales.append(math.sqrt(variance) if variance > 1e-24 * (1 + mean * mean) else math.inf)
    return means, scales


def maximize(rows, ridge):
    """Newton's method on the log-likelihood less ridge / 2 times the squares of all weights but the constant's."""
    size = len(rows[0].features)
    solution = [0.0] * size
    for _ in range(MAX_STEPS):
        gradient = [-ridge * w if k else 0.0 for k, w in enumerate(solution)]
        curvature = [[ridge if i == k and k else 0.0 for i in range(size)] for k in range(size)]
        for row in rows:
            x = row.features
            p = logistic(sum(w * value for w, value in zip(solution, x)))
            slope = row.weight * (row.outcome - p)
            bend = row.weight * p * (1 - p)
            for k in range(size):
                gradient[k] += slope * x[k]
                bent = bend * x[k]
                for i in range(k + 1):
                    curvature[k][i] += bent * x[i]
        for k in range(size):
            for i in range(k):
                curvature[i][k] = curvature[k][i]
        step = solve(curvature, gradient)
        # Far steps overshoot where the outcomes are all but separable.
        reach = max(abs(s) for s in step)
        solution = [w + s * min(1.0, 2 / reach if reach else 1.0) for w, s in zip(solution, step)]
        if reach < CLOSE:
            break
    return solution


def solve(matrix, right):
    """Gaussian elimination with pivots."""
    rows = [row[:] + [value] for row, value in zip(matrix, right)]
    size = len(rows)
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        for i in range(k + 1, size):
            factor = rows[i][k] / rows[k][k]
            for j in range(k, size + 1):
                rows[i][j] -= factor * rows[k][j]
    solution = [0.0] * size
    for k in reversed(range(size)):
        solution[k] = (rows[k][size] - sum(rows[k][j] * solution[j] for j in range(k + 1, size))) / rows[k][k]
    return solution


def log_loss(samples, probabilities):
    """Mean of -log of the probability that was given to what happened."""
    total = sum(sample.weight for sample in samples)
    return -sum(sample.weight * math.log(max(1e-15, p if sample.outcome else 1 - p))
                for sample, p in zip(samples, probabilities)) / total


def brier_score(samples, probabilities):
    total = sum(sample.weight for sample in samples)
    return sum(sample.weight * (p - sample.outcome) ** 2 for sample, p in zip(samples, probabilities)) / total


def expected_error(samples, probabilities):
    """As docs/evaluation.md defines it, samples counting by their weight."""
    tenths = [0.0] * 10
    for sample, p in zip(samples, probabilities):
        tenths[min(9, int(10 * p))] += sample.weight * (p - sample.outcome)
    return sum(abs(tenth) for tenth in tenths) / sum(sample.weight for sample in samples)
