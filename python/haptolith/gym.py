"""Digging as a task for learning, in the form of Gymnasium's API.

With gymnasium installed the environments have its spaces; without, plain stand-ins with shape, low, high, sample() and
contains(). Checked against the documented API of gymnasium 1.x, never against the package itself.
"""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np
import numpy.typing as npt

from .batch import Batch
from .scene import Scene
from .values import Floats


def _optional(module: str) -> Any:
    try:
        return importlib.import_module(module)
    except ImportError:
        return None


_spaces: Any = _optional("gymnasium.spaces")

Observation = dict[str, npt.NDArray[np.float32]]
Reward = Callable[["Episode"], float]


@dataclass
class Box:
    """Substitute for gymnasium.spaces.Box."""

    low: float
    high: float
    shape: tuple[int, ...]
    dtype: Any = np.float32

    def sample(self, random: Optional[np.random.Generator] = None) -> npt.NDArray[Any]:
        """A random element."""
        low, high = max(self.low, -1.0), min(self.high, 1.0)
        return (random or np.random.default_rng()).uniform(low, high, self.shape).astype(self.dtype)

    def contains(self, x: npt.ArrayLike) -> bool:
        """Whether x is an element."""
        given = np.asarray(x)
        return given.shape == self.shape and bool(np.all((given >= self.low) & (given <= self.high)))


def _box(low: float, high: float, shape: tuple[int, ...]) -> Any:
    return Box(low, high, shape) if _spaces is None else _spaces.Box(low, high, shape, np.float32)


class Episode:
    """State of one scene during digging, for rewards."""

    def __init__(self, scene: Scene, grid: int, level_m: float) -> None:
        self.scene, self.grid, self.level_m = scene, grid, level_m
        info = scene.info
        self.start = scene.state
        self.width_m, self.length_m, self.surface_m = info.width_m, info.length_m, info.surface_m
        self.radius_m, self.mass_kg = info.radius_m, info.mass_kg
        self.pose = np.zeros(7)
        self.felt = np.zeros(6)
        self.steps = 0
        self.lifted_kg = 0.0
        self.lifted_before_kg = 0.0

    def __repr__(self) -> str:
        return f"<haptolith.gym.Episode: {self.steps} actions, {self.lifted_kg:.3g} kg above the surface, {self.scene!r}>"

    def begin(self, random: np.random.Generator) -> None:
        """Undisturbed soil, the tool somewhere above it."""
        self.scene.state = self.start
        beside = random.uniform(-0.25, 0.25, 2) * [self.width_m, self.length_m]
        self.pose = np.array([*beside, self.surface_m + 0.03, 1.0, 0.0, 0.0, 0.0])
        self.scene.place_tool(self.pose)
        self.felt = np.zeros(6)
        self.steps = 0
        self.lifted_kg = self.lifted_before_kg = self._lifted()

    def path(self, velocity_m_s: Floats, ticks: int) -> Floats:
        """(ticks, 7): where the tool goes at that velocity, never out of the space above the box."""
        tick_s = 1e-3
        way = self.pose[:3] + velocity_m_s * tick_s * np.arange(1, ticks + 1)[:, None]
        low = [-self.width_m / 2, -self.length_m / 2, 0.0]
        high = [self.width_m / 2, self.length_m / 2, self.surface_m + 0.15]
        poses = np.tile(self.pose, (ticks, 1))
        poses[:, :3] = np.clip(way, low, high)
        return poses

    def moved(self, poses: Floats, felt: Floats) -> None:
        """Takes note of where the tool went and what it felt."""
        self.pose, self.felt = poses[-1], felt.mean(axis=0)
        self.steps += 1
        self.lifted_before_kg, self.lifted_kg = self.lifted_kg, self._lifted()

    def _lifted(self) -> float:
        """Mass of soil that is higher than the undisturbed surface by level_m, if all grains are of one mass."""
        return float(np.count_nonzero(self.scene.positions[:, 2] > self.surface_m + self.level_m)) * self.mass_kg

    def heights(self) -> npt.NDArray[np.float32]:
        """(grid, grid) m: the highest grain's top in each cell, 0 in empty cells."""
        places = self.scene.positions
        heights = np.zeros((self.grid, self.grid), np.float32)
        i = np.clip(((places[:, 0] / self.width_m + 0.5) * self.grid).astype(int), 0, self.grid - 1)
        j = np.clip(((places[:, 1] / self.length_m + 0.5) * self.grid).astype(int), 0, self.grid - 1)
        np.maximum.at(heights, (i, j), places[:, 2] + np.float32(self.radius_m))
        return heights

    def observation(self) -> Observation:
        """tool (7,), wrench (6,) mean of the last action, heights (grid, grid)."""
        return {"tool": self.pose.astype(np.float32), "wrench": self.felt.astype(np.float32), "heights": self.heights()}


def soil_lifted(episode: Episode) -> float:
    """The usual reward: kg of soil that the last action has brought above the surface."""
    return episode.lifted_kg - episode.lifted_before_kg


def _observation_space(grid: int) -> Any:
    boxes = {"tool": _box(-np.inf, np.inf, (7,)), "wrench": _box(-np.inf, np.inf, (6,)),
             "heights": _box(0.0, np.inf, (grid, grid))}
    return boxes if _spaces is None else _spaces.Dict(boxes)


class DigEnv:
    """A tool that digs. action (3,) in -1 to 1: the tool's velocity over speed_m_s, for ticks_per_action ticks of 1 ms.

    scene: a Scene, or the name or file of one; of several tools the first digs. The same seed and actions give the same episode, bit for bit."""

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode = None
    spec = None

    def __init__(self, scene: Union[Scene, str] = "icra2021", *, speed_m_s: float = 0.2, ticks_per_action: int = 20,
                 most_steps: int = 250, grid: int = 16, level_m: float = 0.02, reward: Reward = soil_lifted) -> None:
        self.episode = Episode(Scene(scene) if isinstance(scene, str) else scene, grid, level_m)
        self.speed_m_s, self.ticks, self.most_steps, self.reward = speed_m_s, ticks_per_action, most_steps, reward
        self.action_space = _box(-1.0, 1.0, (3,))
        self.observation_space = _observation_space(grid)
        self.np_random = np.random.default_rng()

    def __repr__(self) -> str:
        return f"<haptolith.gym.DigEnv: {self.episode.scene!r}, {self.ticks} ticks an action, {self.most_steps} actions at most>"

    @property
    def unwrapped(self) -> DigEnv:
        """This one: nothing is wrapped."""
        return self

    def reset(self, *, seed: Optional[int] = None, options: Optional[Mapping[str, Any]] = None) -> tuple[Observation, dict[str, Any]]:
        """Begins an episode: undisturbed soil, the tool somewhere above it."""
        del options
        if seed is not None:
            self.np_random = np.random.default_rng(seed)
        self.episode.begin(self.np_random)
        return self.episode.observation(), {}

    def step(self, action: npt.ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """observation, reward, terminated, truncated, info. Raises ValueError for an action that is not (3,) numbers."""
        poses = self.episode.path(_velocity(action, self.speed_m_s), self.ticks)
        self.episode.moved(poses, self.episode.scene.steps(poses))
        return (self.episode.observation(), self.reward(self.episode), False, self.episode.steps >= self.most_steps,
                {"lifted_kg": self.episode.lifted_kg})

    def close(self) -> None:
        """Gives the scene back."""
        self.episode.scene.close()


class VecDigEnv:
    """n of them, stepped together on threads. An episode that has ended restarts with the next step(), whose action
    does not count for it (autoreset mode "next step")."""

    def __init__(self, n: int, scene: str = "icra2021", *, threads: int = 0, **of_each: Any) -> None:
        first = DigEnv(scene, **of_each)
        self.envs = [first] + [DigEnv(first.episode.scene.clone(), **of_each) for _ in range(n - 1)]
        self.num_envs = n
        self.single_action_space, self.single_observation_space = first.action_space, first.observation_space
        self.metadata = {**first.metadata, "autoreset_mode": _next_step()}
        self._batch = Batch([env.episode.scene for env in self.envs], threads)
        self._ended = np.zeros(n, np.bool_)

    def __repr__(self) -> str:
        return f"<haptolith.gym.VecDigEnv of {self.num_envs}: {self.envs[0]!r}>"

    def reset(self, *, seed: Union[None, int, Sequence[Optional[int]]] = None,
              options: Optional[Mapping[str, Any]] = None) -> tuple[Observation, dict[str, Any]]:
        """Begins all episodes; seed, seed + 1, ... or one for each."""
        seeds = [None if seed is None else seed + i for i in range(self.num_envs)] if seed is None or isinstance(seed, int) else list(seed)
        for env, own in zip(self.envs, seeds):
            env.reset(seed=own, options=options)
        self._ended[:] = False
        return self._observations(), {}

    def step(self, actions: npt.ArrayLike) -> tuple[Observation, Floats, npt.NDArray[np.bool_], npt.NDArray[np.bool_], dict[str, Any]]:
        """(n, 3) actions; observations, rewards (n,), terminated (n,), truncated (n,), info."""
        given = np.asarray(actions, dtype=np.float64)
        if given.shape != (self.num_envs, 3):
            raise ValueError(f"actions are ({self.num_envs}, 3), not {given.shape}")
        anew = self._ended.copy()
        for i in np.flatnonzero(anew):
            self.envs[i].reset()
        poses = np.stack([env.episode.path(_velocity(0 * a if new else a, env.speed_m_s), env.ticks)
                          for env, a, new in zip(self.envs, given, anew)])
        felt = self._batch.step(poses)
        rewards = np.zeros(self.num_envs)
        for i, env in enumerate(self.envs):
            env.episode.moved(poses[i], felt[i])
            if anew[i]:
                env.episode.steps = 0
            else:
                rewards[i] = env.reward(env.episode)
        self._ended = np.array([env.episode.steps >= env.most_steps for env in self.envs])
        return self._observations(), rewards, np.zeros(self.num_envs, np.bool_), self._ended.copy(), {}

    def _observations(self) -> Observation:
        each = [env.episode.observation() for env in self.envs]
        return {name: np.stack([one[name] for one in each]) for name in each[0]}

    def close(self) -> None:
        """Ends the threads and gives the scenes back."""
        self._batch.close()
        for env in self.envs:
            env.close()


def _velocity(action: npt.ArrayLike, speed_m_s: float) -> Floats:
    given = np.asarray(action, dtype=np.float64)
    if given.shape != (3,) or not np.all(np.isfinite(given)):
        raise ValueError("an action is 3 finite numbers, -1 to 1: the tool's velocity over the largest")
    return np.clip(given, -1, 1) * speed_m_s


def _next_step() -> Any:
    vector = _optional("gymnasium.vector")
    return "NextStep" if vector is None else vector.AutoresetMode.NEXT_STEP
