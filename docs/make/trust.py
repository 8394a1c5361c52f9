#!/usr/bin/env python3
"""Examines built-in scenes by `haptolith trust`, and writes the table of docs/reports/trust.md, a row as soon as it is known.

trust.py [--minutes N] [SCENE...]     all built-in scenes, 2 minutes each; the program is $HAPTOLITH or the release build's
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
PAGE = SOURCE / "docs/reports/trust.md"
HEAD = "| Scene | Mean force / N | within | Peak / N | within | another specimen | box x; y | deeper | R halved | step halved | k doubled | Complaints |"


def percent(fraction: float) -> str:
    """Rounded to whole percent."""
    return f"{100 * fraction:.0f} %"


def shift(effects: dict[str, dict], change: str) -> str:
    """The change of the mean force, towards half the radius for another one."""
    effect = effects.get(change)
    if not effect or "mean" not in effect:
        return "-"
    factor = 0.5 / (1 - effect["radius_ratio"]) if change == "radius" else 1
    return f"{100 * factor * effect['mean']['change']:+.0f} ± {100 * abs(factor) * effect['mean']['standard_error']:.0f}"


def row(scene: str, told: dict) -> str:
    """A line of the table."""
    if told["mean_force_n"] < 1e-6:
        return f"| {scene} | 0 | | | | | | | | | | no force in this movement |"
    effects = {effect["change"]: effect for effect in told["effects"]}
    return (f"| {scene} | {told['mean_force_n']:.2g} | {percent(told['mean_within'])} | {told['peak_force_n']:.2g} | {percent(told['peak_within'])} "
            f"| ± {percent(told['scatter_mean'])} | {shift(effects, 'wide-x')}; {shift(effects, 'wide-y')} | {shift(effects, 'deep')} "
            f"| {shift(effects, 'radius')} | {shift(effects, 'step')} | {shift(effects, 'stiff')} | {', '.join(told['complaints'] + [f'near: {what}' for what in told['near_but_not_felt']]) or 'none'} |")


def write(scene: str, line: str) -> None:
    """Replaces the scene's row, or adds it."""
    lines = PAGE.read_text().splitlines()
    first = lines.index(HEAD) + 2
    last = next(i for i in range(first, len(lines) + 1) if i == len(lines) or not lines[i].startswith("|"))
    rows = {text.split("|")[1].strip(): text for text in lines[first:last]} | {scene: line}
    PAGE.write_text("\n".join(lines[:first] + [rows[name] for name in sorted(rows)] + lines[last:]) + "\n")


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--minutes", type=float, default=2)
    asked = parser.parse_args()
    program = os.environ.get("HAPTOLITH", SOURCE / "build/release/apps/haptolith/haptolith")
    scenes = asked.scenes or sorted(path.stem for path in (SOURCE / "scenes").glob("*.toml"))
    for scene in scenes:
        with tempfile.TemporaryDirectory() as cache:  # so that times do not depend on what has settled before
            done = subprocess.run([program, "trust", scene, "--minutes", f"{asked.minutes:g}", "--json"], stdout=subprocess.PIPE,
                                  env=os.environ | {"HAPTOLITH_CACHE": cache}, text=True, check=False)
        if done.returncode != 0:
            print(f"{scene}: exit status {done.returncode}", file=sys.stderr)
            continue
        told = json.loads(done.stdout)
        print(f"{scene}: {told['took_s']:.0f} s: {told['sentence']}", file=sys.stderr)
        write(scene, row(scene, told))


if __name__ == "__main__":
    main()
