#!/usr/bin/env python3
"""Examines scenes by `haptolith trust`, and writes the tables of docs/reports/trust.md, a row as soon as it is known.

trust.py [--minutes N] [SCENE...]     all built-in scenes, 2 minutes each; the program is $HAPTOLITH or the release build's
trust.py --test [NUMBER...]           ten other scenes, each against its limit: a box of 4 times the area, particles half as large, 5 other seeds
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

TEST_HEAD = "| Scene | Movement | Mean, limit over scene | Stated bound | Peak, limit over scene | Stated bound |"
# Soil, body, R, width, length and depth in mm, keys of the tool and of the hand.
TEST_SCENES = [
    ("lunar-0-15cm", "Moon", 7, 140, 140, 45, "shape = 'box'", "motion = 'stir'"),
    ("lunar-0-15cm", "Earth", 8, 160, 120, 50, "shape = 'plate'\ndiameter_mm = 50", "motion = 'press'\ndepth_mm = 15"),
    ("soft-sand", "Earth", 7, 130, 130, 40, "shape = 'box'", "motion = 'scoop'"),
    ("soft-sand", "Moon", 8, 150, 150, 60, "shape = 'sphere'\ndiameter_mm = 40", "motion = 'stir'\ndepth_mm = 25"),
    ("toyoura", "Moon", 7, 140, 140, 50, "shape = 'cylinder'\ndiameter_mm = 20\nlength_mm = 60", "motion = 'press'\ndepth_mm = 10"),
    ("toyoura", "Earth", 9, 180, 150, 55, "shape = 'box'", "motion = 'stir'\ncompliance = 'rigid'"),
    ("lunar-0-15cm", "Mars", 7, 126, 126, 40, "shape = 'box'\nsize_mm = [60, 30, 5]", "motion = 'cut'"),
    ("soft-sand", "Mars", 7, 120, 160, 45, "shape = 'plate'\ndiameter_mm = 60",
     "motion = 'press'\ndepth_mm = 12\ncompliance = 'rigid'\nmax_force_n = 1000"),
    ("lunar-0-15cm", "Moon", 9, 160, 160, 60, "model = 'scoop'", "motion = 'scoop'\ndepth_mm = 20"),
    ("toyoura", "Mars", 7, 150, 130, 45, "shape = 'box'\nsize_mm = [40, 50, 8]", "motion = 'furrows'"),
]


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


def row(scene: str, verdict: dict) -> str:
    """A line of the table."""
    if verdict["mean_force_n"] < 1e-6:
        return f"| {scene} | 0 | | | | | | | | | | no force in this movement |"
    effects = {effect["change"]: effect for effect in verdict["effects"]}
    return (f"| {scene} | {verdict['mean_force_n']:.2g} | {percent(verdict['mean_within'])} | {verdict['peak_force_n']:.2g} | {percent(verdict['peak_within'])} "
            f"| ± {percent(verdict['scatter_mean'])} | {shift(effects, 'wide-x')}; {shift(effects, 'wide-y')} | {shift(effects, 'deep')} "
            f"| {shift(effects, 'radius')} | {shift(effects, 'step')} | {shift(effects, 'stiff')} | {', '.join(verdict['complaints'] + [f'near: {what}' for what in verdict['near_but_not_felt']]) or 'none'} |")


def write(head: str, scene: str, line: str) -> None:
    """Replaces the scene's row in the table with this head, or adds it."""
    lines = PAGE.read_text().splitlines()
    first = lines.index(head) + 2
    last = next(i for i in range(first, len(lines) + 1) if i == len(lines) or not lines[i].startswith("|"))
    rows = {text.split("|")[1].strip(): text for text in lines[first:last]} | {scene: line}
    PAGE.write_text("\n".join(lines[:first] + [rows[name] for name in sorted(rows)] + lines[last:]) + "\n")


def trust(scene: str, *options: str) -> dict | None:
    """Verdict of the program; its progress goes to standard error."""
    program = os.environ.get("HAPTOLITH", SOURCE / "build/release/apps/haptolith/haptolith")
    with tempfile.TemporaryDirectory() as cache:  # so that times do not depend on what has settled before
        done = subprocess.run([program, "trust", scene, "--json", *options], stdout=subprocess.PIPE, text=True, check=False,
                              env=os.environ | {"HAPTOLITH_CACHE": cache})
    if done.returncode != 0:
        print(f"{scene}: exit status {done.returncode}", file=sys.stderr)
        return None
    verdict = json.loads(done.stdout)
    print(f"{scene}: {verdict['took_s']:.0f} s: {verdict['sentence']}", file=sys.stderr)
    return verdict


def test(number: int) -> None:
    """Compares a scene that is not built in with its limit."""
    soil, body, radius, width, length, depth, tool, hand = TEST_SCENES[number]
    with tempfile.NamedTemporaryFile("w", suffix=".toml") as file:
        file.write(f"title = 'scene {number}'\n[soil]\nname = '{soil}'\nradius_mm = {radius}\n[gravity]\nbody = '{body}'\n"
                   f"[bed]\nstart = 'settled'\nwidth_mm = {width}\nlength_mm = {length}\ndepth_mm = {depth}\n"
                   f"sleep_speed_m_s = 1e-2\nsleep_distance_mm = 0.05\n[tool]\n{tool}\n[hand]\n{hand}\n")
        file.flush()
        stated = trust(file.name, "--minutes", "4", "--only", "wide-x,wide-y,deep,radius,step,stiff")
        limit = trust(file.name, "--set", f"bed.width_mm={2 * width}", "--set", f"bed.length_mm={2 * length}",
                      "--set", f"soil.radius_mm={radius / 2}", "--seed", "101", "--only", "specimen", "--minutes", "1000")
    if not stated or not limit:
        return
    shape, motion = tool.split("'")[1], hand.split("'")[1]
    cells = [f"{number + 1}: {soil}, {body}, {shape}", motion]
    for force in ("mean", "peak"):
        shift = limit[f"{force}_force_n"] / stated[f"{force}_force_n"] - 1
        within = stated[f"{force}_within"]
        cells += [f"{100 * shift:+.0f} % {'🟢' if abs(shift) <= within else '🔴'}", f"± {percent(within)}"]
    write(TEST_HEAD, cells[0], f"| {' | '.join(cells)} |")


def main() -> None:
    """Reads the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("scenes", nargs="*")
    parser.add_argument("--minutes", type=float, default=2)
    parser.add_argument("--test", action="store_true")
    asked = parser.parse_args()
    if asked.test:
        for number in map(int, asked.scenes or range(len(TEST_SCENES))):
            test(number)
        return
    for scene in asked.scenes or sorted(path.stem for path in (SOURCE / "scenes").glob("*.toml")):
        if verdict := trust(scene, "--minutes", f"{asked.minutes:g}"):
            write(HEAD, scene, row(scene, verdict))


if __name__ == "__main__":
    main()
