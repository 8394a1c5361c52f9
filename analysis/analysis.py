#!/usr/bin/env python3
"""Reproduces the numbers of `haptolith study figure` from an export of the study, and fits mixed models for comparison.

    python3 friction-analysis.py                 reads friction.csv next to it
    python3 analysis.py FOLDER                   a BIDS export
    python3 analysis.py friction.csv --json      numbers alone; --no-glmm leaves the mixed models out

Needs numpy and scipy; statsmodels for the mixed models (Debian: python3-numpy python3-scipy python3-statsmodels).

The model (docs/reference/psychometrics.md). Person i answers "more" to the stimulus x with the probability

    psi(x) = c + (1 - 2 c) Phi((ln x - t_i) / ln(1 + w_i)),   t_i ~ N(m_t, s_t),   ln w_i ~ N(m_w, s_w)

and a common lapse rate c. Each group of a study is fitted separately. exp(m_t) is the PSE of the median person, exp(m_w)
their Weber fraction. R is the range of ln x, and d the minimum distance between two values. The priors are:
m_t flat over the stimuli, decreasing to 0 as a cosine over R/2 on either side; m_w flat for widths 3.29 ln(1 + w) from
d/4 to 3 R; s_t and s_w half-normal with R/4 and 0.6; c Beta(1, 100) up to 1/2. A single person's responses are fitted
without lapses, and w has the prior 1/w^2.
"""

import argparse
import csv
import json
import math
import pathlib
import sys

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import log_ndtr, ndtr

WIDTH = 3.289707253902943  # from 5 % to 95 % of a normal distribution, in standard deviations
PLACES = 61                # grid points of a person's table, per axis
COARSE, FINE = (11, 6, 11, 6, 6), (19, 11, 19, 11, 9)
USUAL_LOG_SPREAD = 0.6
LAPSE_PRIOR = 100
LEFT_OUT = ("withdrawn", "excluded")  # participant_state


# --- data ---------------------------------------------------------------------------------------------------------------


def rows_of(path):
    """Every trial of a CSV file or of a BIDS folder, as a dictionary."""
    if path.is_dir():
        people = {}
        with open(path / "participants.tsv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file, delimiter="\t"):
                people[row["participant_id"]] = row
        for table in sorted(path.glob("sub-*/beh/*_beh.tsv")):
            names = dict(part.split("-", 1) for part in table.stem.split("_") if "-" in part)
            with open(table, newline="", encoding="utf-8") as file:
                for row in csv.DictReader(file, delimiter="\t"):
                    person = people.get("sub-" + names["sub"], {})
                    yield {**row, "participant": names["sub"], "block": names["task"], "kind": row["trial_type"],
                           "participant_state": person.get("state", ""), "group": person.get("group", "")}
    else:
        with open(path, newline="", encoding="utf-8") as file:
            yield from csv.DictReader(file)


def blocks_of(path):
    """Analysed responses {(block, group): (reference, {participant: {x: [k, n]}})}, without excluded participants."""
    blocks = {}
    for row in rows_of(path):
        counts = row["kind"] == "main" and row["state"] == "answered" and row["response"] in ("0", "1")
        if not counts or row.get("participant_state") in LEFT_OUT or row.get("timed_out") == "1":
            continue
        _, people = blocks.setdefault((row["block"], row.get("group") or ""), (float(row["x_reference"]), {}))
        level = people.setdefault(row["participant"], {}).setdefault(float(row["x"]), [0, 0])
        level[0] += int(row["response"])
        level[1] += 1
    return blocks


# --- the model ----------------------------------------------------------------------------------------------------------


class Priors:
    def __init__(self, people):
        places = sorted({math.log(x) for person in people for x in person})
        self.first, self.last = places[0], places[-1]
        self.range = self.last - self.first
        least = min(b - a for a, b in zip(places, places[1:]))
        self.places = (self.first - self.range / 2, self.last + self.range / 2)
        self.log_w = tuple(math.log(math.expm1(width / WIDTH)) for width in (least / 4, 3 * self.range))
        self.usual_place_spread = self.range / 4
        self.supports = [self.places, (0, 4 * self.usual_place_spread), self.log_w, (0, 4 * USUAL_LOG_SPREAD), (0, 0.5)]

    def place(self, t):
        outside = np.maximum(np.maximum(self.first - t, t - self.last), 0)
        share = np.clip(outside / (self.range / 2), 0, 1)
        return np.log(np.maximum((1 + np.cos(np.pi * share)) / 2, 1e-300))

    def logs(self, grids):
        t, s_t, u, s_u, c = grids
        return (self.place(t), -(s_t / self.usual_place_spread) ** 2 / 2, 0 * u, -(s_u / USUAL_LOG_SPREAD) ** 2 / 2,
                (LAPSE_PRIOR - 1) * np.log1p(-c))


def log_likelihood(person, t, u, lapse):
    """Log-likelihood of one person's responses over thresholds t (rows) and ln w (columns)."""
    sigma = np.log1p(np.exp(u))[None, :]
    total = np.zeros((len(t), len(u)))
    for x, (k, n) in person.items():
        z = (math.log(x) - t[:, None]) / sigma
        if lapse == 0:
            total += k * log_ndtr(z) + (n - k) * log_ndtr(-z)
        else:
            psi = lapse + (1 - 2 * lapse) * ndtr(z)
            total += k * np.log(psi) + (n - k) * np.log1p(-psi)
    return total


def table_of(person, priors, lapses):
    """Grids of t and ln w that cover the relevant part of a person's likelihood."""
    supports = [priors.places, priors.log_w]
    for _ in range(2):
        values = [np.linspace(*support, PLACES) for support in supports]
        kept = np.zeros((PLACES, PLACES), bool)
        for lapse in lapses:
            log = log_likelihood(person, *values, lapse)
            kept |= log >= log.max() - 12
        for axis in (0, 1):
            at = np.flatnonzero(kept.any(axis=1 - axis))
            supports[axis] = values[axis][max(at[0] - 1, 0)], values[axis][min(at[-1] + 1, PLACES - 1)]
    return [np.linspace(*support, PLACES) for support in supports]


def normal_weights(means, spreads, values):
    """Weights of `values` for the means over normal distributions (rows) of a function that is linear between them."""
    mean = np.repeat(means, len(spreads))[:, None]
    spread = np.maximum(np.tile(spreads, len(means)), 1e-12)[:, None]
    z = (values - mean) / spread
    integral = (values - mean) * ndtr(z) + spread * np.exp(-z * z / 2) / math.sqrt(2 * math.pi)
    slopes = np.diff(integral, axis=1) / (values[1] - values[0])
    ends = np.zeros((len(mean), 1))
    return np.diff(np.hstack([ends, slopes, ends + 1]), axis=1)


def trapezoid(values):
    weights = np.zeros(len(values))
    halves = np.diff(values) / 2
    weights[1:] += halves
    weights[:-1] += halves
    return weights


def posterior_on(people, tables, priors, supports, sizes):
    """Log posterior density over [m_t, s_t, m_w, s_w, c], and the grid of each."""
    grids = [np.linspace(low, high, size) for (low, high), size in zip(supports, sizes)]
    low, high = supports[4]
    grids[4] = low + (high - low) * np.linspace(0, 1, sizes[4]) ** (1 if low > 0 else 2)
    logs = priors.logs(grids)
    density = sum(log.reshape([-1 if i == axis else 1 for i in range(5)]) for axis, log in enumerate(logs))
    for person, (t, u) in zip(people, tables):
        of_t = normal_weights(grids[0], grids[1], t)
        of_u = normal_weights(grids[2], grids[3], u)
        likelihoods = np.stack([log_likelihood(person, t, u, lapse) for lapse in grids[4]])
        likelihoods = np.exp(likelihoods - likelihoods.max())
        for c, likelihood in enumerate(likelihoods):
            integral = of_t @ likelihood @ of_u.T
            density[..., c] += np.log(np.maximum(integral, 1e-300)).reshape(sizes[:4])
    return density, grids


def quantiles(values, log_density, shares):
    """Quantiles of a density whose logarithm is a cubic spline."""
    fine = np.linspace(values[0], values[-1], 4001)
    density = np.exp(CubicSpline(values, np.maximum(log_density, -40))(fine))
    cumulated = np.concatenate([[0], np.cumsum((density[1:] + density[:-1]) / 2)])
    return np.interp(np.array(shares) * cumulated[-1], cumulated, fine)


def marginal(density, grids, axis):
    mass = np.exp(density - density.max())
    for other in range(5):
        if other != axis:
            shape = [-1 if i == other else 1 for i in range(5)]
            mass = mass * trapezoid(grids[other]).reshape(shape)
    sums = mass.sum(axis=tuple(i for i in range(5) if i != axis))
    return np.log(np.maximum(sums / sums.max(), 1e-300))


def fit_group(people, confidence):
    priors = Priors(people)
    tables = [table_of(person, priors, (0.001, 0.02, 0.08)) for person in people]
    supports = priors.supports
    for _ in range(4):
        density, grids = posterior_on(people, tables, priors, supports, COARSE)
        kept = density > density.max() - 9
        for axis in range(5):
            at = np.flatnonzero(kept.any(axis=tuple(i for i in range(5) if i != axis)))
            supports = list(supports)
            supports[axis] = grids[axis][max(at[0] - 1, 0)], grids[axis][min(at[-1] + 1, len(grids[axis]) - 1)]
    density, grids = posterior_on(people, tables, priors, supports, FINE)
    shares = (0.5, (1 - confidence) / 2, (1 + confidence) / 2)
    t, s_t, u, s_u, c = (quantiles(grids[i], marginal(density, grids, i), shares) for i in range(5))
    return {"pse": np.exp(t), "weber_fraction": np.exp(u), "lapse": c, "threshold_spread": s_t,
            "weber_fraction_spread": s_u}


def fit_one(person, confidence):
    priors = Priors([person])
    t, u = table_of(person, priors, (0,))
    density = np.exp(log_likelihood(person, t, u, 0) + priors.place(t)[:, None] - u[None, :])
    density /= density.max()
    shares = (0.5, (1 - confidence) / 2, (1 + confidence) / 2)
    logs = [np.log(np.maximum(density.sum(axis=1 - axis), 1e-300)) for axis in (0, 1)]
    return {"pse": np.exp(quantiles(t, logs[0] - logs[0].max(), shares)),
            "weber_fraction": np.exp(quantiles(u, logs[1] - logs[1].max(), shares))}


# --- mixed models -------------------------------------------------------------------------------------------------------


def mixed_model(people):
    """A logistic mixed model by statsmodels (variational Bayes): intercepts and slopes of people are normal."""
    from statsmodels.genmod.bayes_mixed_glm import BinomialBayesMixedGLM

    answers, places, who = [], [], []
    for index, person in enumerate(people):
        for x, (k, n) in person.items():
            answers += [1] * k + [0] * (n - k)
            places += [math.log(x)] * n
            who += [index] * n
    places = np.array(places)
    middle = places.mean()
    of_person = np.eye(len(people))[who]
    effects = np.hstack([of_person, of_person * (places - middle)[:, None]])
    kinds = np.repeat([0, 1], len(people))
    model = BinomialBayesMixedGLM(np.array(answers), np.column_stack([np.ones(len(places)), places - middle]), effects,
                                  kinds, vcp_p=1, fe_p=10)
    intercept, slope = model.fit_vb().fe_mean
    jnd = math.log(0.8413447460685429 / 0.1586552539314571) / slope  # distance to 84 %, on the axis of ln x
    return {"pse": math.exp(middle - intercept / slope), "weber_fraction": math.expm1(jnd)}


# --- the program --------------------------------------------------------------------------------------------------------


def analysis_of(path, confidence, with_mixed_models):
    results = []
    for (name, group), (reference, by_person) in blocks_of(path).items():
        people = list(by_person.values())
        if reference <= 0 or min(x for person in people for x in person) <= 0:
            print(f"{name}: values at or below 0 have no Weber fraction; left out", file=sys.stderr)
            continue
        fit = fit_group(people, confidence) if len(people) > 1 else fit_one(people[0], confidence)
        result = {"block": name, "participants": len(people), "reference": reference,
                  "answers": sum(n for person in people for _, n in person.values())}
        for key, (value, low, high) in fit.items():
            result[key] = float(value)
            result[key + "_interval"] = [float(low), float(high)]
        if group:
            result["of_group"] = group
        if with_mixed_models and len(people) > 1:
            try:
                result["mixed_model"] = mixed_model(people)
            except ImportError:
                print("statsmodels is not installed: no mixed model", file=sys.stderr)
        results.append(result)
    return results


def main():
    own = pathlib.Path(__file__)
    beside = own.with_name(own.name.replace("-analysis.py", ".csv"))
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("data", nargs="?", type=pathlib.Path, default=beside, help="CSV file or BIDS folder")
    parser.add_argument("--confidence", type=float, default=0.95)
    parser.add_argument("--no-glmm", action="store_true")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.data == own or not options.data.exists():
        parser.error(f"{options.data}: no export of a study; give its path")
    results = analysis_of(options.data, options.confidence, not options.no_glmm)
    if options.json:
        print(json.dumps(results, indent=2))
        return
    for result in results:
        group = f" of group {result['of_group']}" if "of_group" in result else ""
        plural = "" if result["participants"] == 1 else "s"
        print(f"{result['block']}{group}: {result['participants']} participant{plural}, {result['answers']} answers, "
              f"reference {result['reference']:g}")
        for key, what in (("weber_fraction", "Weber fraction"), ("pse", "PSE"), ("lapse", "lapse rate"),
                          ("weber_fraction_spread", "spread of ln(Weber fraction)"),
                          ("threshold_spread", "spread of ln(PSE)")):
            if key in result:
                low, high = result[key + "_interval"]
                print(f"  {what:<30} {result[key]:8.4g}   {low:.4g} to {high:.4g}")
        if "mixed_model" in result:
            model = result["mixed_model"]
            print(f"  mixed model (logistic)         Weber fraction {model['weber_fraction']:.4g}, PSE {model['pse']:.4g}")


if __name__ == "__main__":
    main()
