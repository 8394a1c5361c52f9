"""The notebooks run, and say what they should."""

import re
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).resolve().parents[2] / "examples/notebooks"


def told_by(name, where):
    notebook = nbformat.read(NOTEBOOKS / name, 4)
    NotebookClient(notebook, timeout=280, kernel_name="python3", resources={"metadata": {"path": str(where)}}).execute()
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", [])]
    assert any("image/png" in output.get("data", {}) for output in outputs)
    return "".join(output.get("text", "") for output in outputs)


def test_there_are_two():
    assert sorted(path.name for path in NOTEBOOKS.glob("*.ipynb")) == ["shear_test.ipynb", "what_a_hand_can_tell.ipynb"]


def test_a_shear_test_gives_friction_and_cohesion(tmp_path):
    told = told_by("shear_test.ipynb", tmp_path)
    by_hand = [float(n) for n in re.search(r"by hand: +([\d.]+) degrees, (\d+) Pa", told).groups()]
    by_haptolith = [float(n) for n in re.search(r"by haptolith: ([\d.]+) \+- [\d.]+ degrees, (\d+) \+-", told).groups()]
    assert by_hand == pytest.approx(by_haptolith, abs=1) and 35 < by_hand[0] < 48


def test_a_made_up_person_is_found_again(tmp_path):
    told = told_by("what_a_hand_can_tell.ipynb", tmp_path)
    forces = [float(n) for n in re.findall(r"m/s\^2: +([\d.]+) N", told)]
    assert len(forces) == 7 and forces == sorted(forces) and forces[0] > 1
    assert 0.15 < float(re.search(r"Weber fraction ([\d.]+)", told).group(1)) < 0.35
