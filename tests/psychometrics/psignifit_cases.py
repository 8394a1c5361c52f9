#!/usr/bin/env python3
"""Fits the answers of psignifit's consistency tests with haptolith and compares with what psignifit published of them.

    psignifit_cases.py FOLDER PROGRAM

FOLDER is a copy of github.com/wichmann-lab/psignifit (its tests/test_cases are read), PROGRAM is haptolith. Differences
are in % of the published threshold and width, and in % of the length of the published 95 % interval for its ends.
"""

import json
import math
import pathlib
import subprocess
import sys
import tempfile

SIGMOIDS = {"logn": ["norm", "--log-x"], "Weibull": ["weibull"]}
DESIGNS = {"2AFC": "2afc", "YesNo": "yesno", "equalAsymptote": "equal-asymptote"}
LOGARITHMIC = ("logn", "Weibull")


def fitted(program, case, options):
    trials = (case.parent / (case.name + "_data.csv")).read_text().split()
    with tempfile.NamedTemporaryFile("w", suffix=".csv") as table:
        table.write("x,k,n\n" + "\n".join(trials) + "\n")
        table.flush()
        sigmoid = SIGMOIDS.get(options["sigmoidName"], [options["sigmoidName"]])
        command = [program, "study", "fit", "--json", "--simulations", "0", "--data", table.name, "--sigmoid", *sigmoid,
                   "--design", DESIGNS[options["expType"]], "--pool-tolerance", str(options["poolxTol"])]
        return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def main(folder, program):
    print(f"{'case':<22} {'threshold':>9} {'width':>7} {'deviance':>17}   ends: threshold       width       lapse"
          "       guess         eta")
    for path in sorted(pathlib.Path(folder, "tests", "test_cases").glob("*_data.csv")):
        case = path.with_name(path.name[: -len("_data.csv")])
        options = json.loads(case.with_name(case.name + "_opt.json").read_text())
        published = json.loads(case.with_name(case.name + "_res.json").read_text())
        fit = fitted(program, case, options)
        if options["sigmoidName"] in LOGARITHMIC:
            fit["threshold"] = math.log(fit["threshold"])
            fit["intervals"]["threshold"] = [math.log(x) for x in fit["intervals"]["threshold"]]
        off = [100 * (fit[key] / published["Fit"][i] - 1) for i, key in enumerate(("threshold", "width"))]
        ends = ""
        for i, key in enumerate(("threshold", "width", "lapse", "guess", "overdispersion")):
            low, high = (end[0] for end in published["conf_Intervals"][i])
            if low is None or high is None or high == low:
                ends += f"{'-':>12}"
                continue
            found = fit["intervals"][key]
            ends += "".join(f"{100 * (a - b) / (high - low):>+6.1f}" for a, b in zip(found, (low, high)))
        print(f"{case.name:<22} {off[0]:>+8.2f}% {off[1]:>+6.2f}% {fit['deviance']:>8.4f} {published['deviance']:>8.4f}"
              f"  {ends}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
