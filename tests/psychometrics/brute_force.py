#!/usr/bin/env python3
"""Numbers for likelihood_test.cpp and fit_test.cpp, from sums over fine grids in plain Python: no code in common."""

import math

LEVELS = [(0.600, 2, 24), (0.648, 4, 24), (0.735, 8, 24), (1.000, 18, 24), (1.210, 22, 24)]
REFERENCE = 0.835


def phi(z):
    return math.erfc(-z / math.sqrt(2)) / 2


def binomial(k, n, psi):
    if (k and psi <= 0) or (n - k and psi >= 1):
        return -math.inf
    return (k * math.log(psi) if k else 0) + ((n - k) * math.log(1 - psi) if n - k else 0)


def beta_binomial(k, n, psi, eta):
    nu = 1 / eta**2 - 1
    a, b = psi * nu, (1 - psi) * nu
    return (math.lgamma(k + a) + math.lgamma(n - k + b) - math.lgamma(n + nu)
            - math.lgamma(a) - math.lgamma(b) + math.lgamma(nu))


def percentiles(values, masses):
    total, below, found = sum(masses), 0, []
    for value, mass in zip(values, masses):
        below += mass
        while len(found) < 3 and below >= total * (0.025, 0.5, 0.975)[len(found)]:
            found.append(value)
    return found


def weber_alone():
    """w alone: prior 1/w^2, widths from a quarter of the least distance to three times the range."""
    places = sorted([math.log(x) for x, _, _ in LEVELS] + [math.log(REFERENCE)])
    least = min(b - a for a, b in zip(places, places[1:]))
    unit = 3.289707253902943
    low, high = math.expm1(least / 4 / unit), math.expm1(3 * (places[-1] - places[0]) / unit)
    count = 40000
    ws = [low + (high - low) * (i + 0.5) / count for i in range(count)]
    masses = [w**-2 * math.exp(sum(binomial(k, n, phi(math.log(x / REFERENCE) / math.log1p(w)))
                                   for x, k, n in LEVELS) + 50) for w in ws]
    evidence = math.log(sum(masses) * (high - low) / count / (1 / low - 1 / high)) - 50
    print("w alone:", percentiles(ws, masses), "log evidence", evidence)


def threshold_and_width():
    """A cumulative Gaussian with lapse and guess rate 0.02: psignifit's priors of threshold and width."""
    xs = [x for x, _, _ in LEVELS]
    first, last, least = xs[0], xs[-1], min(b - a for a, b in zip(xs, xs[1:]))
    spread = last - first

    def threshold_prior(t):
        outside = max(first - t, t - last, 0)
        return (1 + math.cos(math.pi * min(outside / (spread / 2), 1))) / 2

    def width_prior(w):
        rise = 1 if w > 2 * least else (1 - math.cos(math.pi * (w - least) / least)) / 2
        fall = 1 if w < spread else (1 + math.cos(math.pi / 2 * (w - spread) / spread)) / 2
        return rise * fall

    count = 600
    ts = [first - spread / 2 + 2 * spread * (i + 0.5) / count for i in range(count)]
    ws = [least + (3 * spread - least) * (i + 0.5) / count for i in range(count)]
    of_t, of_w, norm_t, norm_w = [0] * count, [0] * count, sum(map(threshold_prior, ts)), sum(map(width_prior, ws))
    for i, t in enumerate(ts):
        for j, w in enumerate(ws):
            log = sum(binomial(k, n, 0.02 + 0.96 * phi((x - t) / w * 3.289707253902943)) for x, k, n in LEVELS)
            mass = threshold_prior(t) * width_prior(w) / norm_t / norm_w * math.exp(log + 50)
            of_t[i] += mass
            of_w[j] += mass
    print("threshold:", percentiles(ts, of_t), "width:", percentiles(ws, of_w),
          "log evidence", math.log(sum(of_t)) - 50)


if __name__ == "__main__":
    for eta in (0.05, 0.3, 0.9):
        print("beta-binomial", eta, [beta_binomial(k, 24, psi, eta) for k, psi in ((0, 0.1), (7, 0.4), (24, 0.97))])
    print("binomial", sum(binomial(k, n, phi(math.log(x / REFERENCE) / math.log(1.29))) for x, k, n in LEVELS))
    weber_alone()
    threshold_and_width()
