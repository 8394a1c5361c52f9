"""What the tests share: two small scenes and a tool that stirs them."""

import math

import numpy as np
import pytest

import haptolith as hp

ICRA2021 = "[bed]\nparticles = 256\n"
CONTACT = ("[soil]\nname = 'lunar-0-15cm'\n[bed]\nstart = 'packed'\nwidth_mm = 126\nlength_mm = 84\ndepth_mm = 40\n")


def stirring(first: int, last: int) -> np.ndarray:
    """(n, 7): where a tool is that digs in circles."""
    tick = np.arange(first, last)
    angle = 2 * math.pi * tick / 500
    poses = np.zeros((len(tick), 7))
    poses[:, 0] = 0.02 * np.sin(angle)
    poses[:, 1] = 0.015 * np.cos(angle) - 0.015
    poses[:, 2] = 0.055 - 0.02 * (1 - np.cos(angle / 3))
    poses[:, 3] = 1
    return poses


@pytest.fixture(params=[ICRA2021, CONTACT], ids=["icra2021", "contact"])
def scene(request):
    with hp.Scene.from_toml(request.param) as made:
        yield made
