#!/usr/bin/env python3
"""Percentiles of the posterior of all parameters, from midpoint sums over dense grids, for dense_sum_test.cpp.

    dense_sum.py [case ...]

Needs numpy and scipy; some minutes a case. Priors as psignifit's, docs/reference/psychometrics.md; no code in common with haptolith.
"""

import sys

import numpy as np
from scipy.special import betaln
from scipy.stats import cauchy, gumbel_l, norm

XS = np.array([0.25, 0.417, 0.583, 0.75, 0.917, 1.083, 1.25, 1.417, 1.583, 1.75])
# name: (shape, alternatives, x, k, n)
CASES = {
    "tdist-3afc": (cauchy, 3, XS, [3, 4, 2, 5, 4, 7, 8, 9, 8, 10], 10),
    "norm-2afc-overdispersed": (norm, 2, XS[1:9], [19, 22, 24, 22, 24, 38, 27, 36], 40),
    "gumbel-2afc": (gumbel_l, 2, XS, [5, 6, 4, 5, 7, 6, 8, 10, 9, 10], 10),
}
PAIRS, RATES, ETAS = 90, 48, 40


def midpoints(count):
    return (np.arange(count) + 0.5) / count


def dense_below(count, high):
    """Points that lie denser at the lower end, and their weights."""
    share = midpoints(count)
    return high * share**2, 2 * high * share / count


def percentiles(edges, masses):
    return np.interp([0.025, 0.975], np.concatenate([[0], np.cumsum(masses) / np.sum(masses)]), edges)


def cosine_fall(share):
    return (1 + np.cos(np.pi * np.clip(share, 0, 1))) / 2


def sums(shape, alternatives, xs, ks, n):
    ks = np.array(ks, float)
    spread, least = xs[-1] - xs[0], np.min(np.diff(xs))
    thresholds = xs[0] - spread / 2 + 2 * spread * midpoints(PAIRS)
    widths = least + (3 * spread - least) * midpoints(PAIRS)
    prior_t = cosine_fall(np.maximum(np.maximum(xs[0] - thresholds, thresholds - xs[-1]), 0) / (spread / 2))
    prior_w = (1 - cosine_fall((widths - least) / least)) * cosine_fall((widths - spread) / (2 * spread))
    rates, weights = dense_below(RATES, 0.5)
    weights = weights * (1 - rates) ** 9
    etas, eta_weights = dense_below(ETAS, 1)
    eta_weights = eta_weights * (1 - etas) ** 9
    lapse = rates[None, :]
    guess = 1 / alternatives
    unit = shape.ppf(0.95) - shape.ppf(0.05)
    marginals = [np.zeros(PAIRS), np.zeros(PAIRS), np.zeros(RATES), np.zeros(ETAS)]
    nu = (1 / etas**2 - 1)[:, None]
    for i, threshold in enumerate(thresholds):
        for j, width in enumerate(widths):
            log = 0
            for x, k in zip(xs, ks):
                psi = guess + (1 - guess - lapse) * shape.cdf(shape.ppf(0.5) + (x - threshold) / width * unit)
                psi = np.clip(psi, 1e-300, 1 - 1e-16)
                log = log + betaln(k + psi * nu, n - k + (1 - psi) * nu) - betaln(psi * nu, (1 - psi) * nu)
            mass = prior_t[i] * prior_w[j] * np.exp(log + n * len(xs) / 2) * weights * eta_weights[:, None]
            total = mass.sum()
            marginals[0][i] += total
            marginals[1][j] += total
            marginals[2] += mass.sum(0)
            marginals[3] += mass.sum(1)
    pairs = np.arange(PAIRS + 1) / PAIRS
    rate_edges, eta_edges = 0.5 * (np.arange(RATES + 1) / RATES) ** 2, (np.arange(ETAS + 1) / ETAS) ** 2
    edges = (xs[0] - spread / 2 + 2 * spread * pairs, least + (3 * spread - least) * pairs, rate_edges, eta_edges)
    for name, edge, marginal in zip(("threshold", "width", "lapse", "overdispersion"), edges, marginals):
        low, high = percentiles(edge, marginal)
        print(f"  {name:<15} {low:.5f} {high:.5f}", flush=True)


if __name__ == "__main__":
    for case in sys.argv[1:] or CASES:
        print(case, flush=True)
        sums(*CASES[case])
