"""Batches, soils, the laboratory, loops, safety and the gym."""

import json
import os
import pickle
import subprocess
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import haptolith as hp
from conftest import CONTACT, ICRA2021, stirring
from haptolith.gym import DigEnv, VecDigEnv


def test_a_batch_gives_the_bits_of_one_by_one():
    scenes = [hp.Scene.from_toml(ICRA2021 if i % 2 else CONTACT, bed__seed=i + 1) for i in range(6)]
    alone = [scene.clone() for scene in scenes]
    poses = np.stack([stirring(40 * i, 40 * i + 80) for i in range(6)])
    with hp.Batch(scenes, threads=2) as batch:
        felt = batch.step(poses)
        assert felt.shape == (6, 80, 6) and len(batch) == 6
        for i in range(6):
            assert np.array_equal(alone[i].steps(poses[i]), felt[i])
            assert alone[i].state_hash == scenes[i].state_hash
        assert batch.step(poses[:, 0]).shape == (6, 6)
        with pytest.raises(ValueError):
            batch.step(poses[:5])
        poses[3, 0, 0] = np.nan
        with pytest.raises(hp.HaptolithError):
            batch.step(poses)
        scenes[2].close()
        with pytest.raises(hp.HaptolithError, match="closed"):
            batch.step(poses)
    with pytest.raises(hp.InvalidParameter):
        hp.Batch([])


def test_a_scene_closed_first_stays_until_its_loop_and_batch_are_closed():
    with hp.Scene.from_toml(ICRA2021, loop__real_time=False, loop__duration_s=0.2) as scene:
        loop = hp.Loop(scene)
    loop.start()
    while loop.snapshot().running:
        time.sleep(0.01)
    assert loop.snapshot().ticks == 200
    loop.close()
    loop.close()
    with pytest.raises(hp.HaptolithError, match="closed"):
        loop.start()
    scene = hp.Scene.from_toml(ICRA2021)
    kept = scene.handle
    batch = hp.Batch([scene])
    scene.close()
    del scene
    assert len(batch._held) == 1 and batch._held[0] is kept
    batch.close()
    assert not batch._held


def test_wrong_arguments_of_long_calls_are_told():
    with pytest.raises(AttributeError):
        hp.Scene.from_toml(7)
    with pytest.raises((TypeError, AttributeError)):
        hp.Soil(7)


def test_soils_are_pickled_by_what_they_are():
    for name in ("P3", "lunar-0-15cm"):
        soil = hp.Soil(name)
        again = pickle.loads(pickle.dumps(soil))
        assert again.profile()["density_kg_m3"].tolist() == soil.profile()["density_kg_m3"].tolist()
    with hp.Soil("P3") as soil:
        pass
    with pytest.raises(hp.HaptolithError, match="closed"):
        soil.profile()


def test_soils_have_numbers_and_profiles():
    soil = hp.Soil("lunar-0-15cm")
    assert soil["soil.radius_mm"] == 7 and soil["target.friction_angle_deg"] > 35
    profile = hp.Soil("P3").profile(1.625, 0.6)
    assert np.all(np.diff(profile["depth_m"]) > 0) and profile["density_kg_m3"][-1] > profile["density_kg_m3"][0]
    assert hp.Soil.from_toml(soil.toml)["soil.contact_friction"] == soil["soil.contact_friction"]
    for wrong in (lambda: soil["soil.colour"], lambda: hp.Soil("moon dust"), lambda: hp.Soil("P1").toml):
        with pytest.raises(hp.InvalidParameter):
            wrong()


def test_the_force_of_a_scene_has_a_bound():
    with hp.Scene("icra2021") as scene:
        verdict = hp.trust(scene, duration_s=2, specimens=2, minutes=1, threads=2, tool="tool")
        assert verdict["sentence"].startswith(("Mean force within", "The force cannot"))
        assert verdict["mean_within"] > 0 and {"wide-x", "deep", "radius", "step"} <= {effect["change"] for effect in verdict["effects"]}
        for wrong in ({"specimens": 1}, {"tool": "left"}, {"seconds": 2}):
            with pytest.raises(hp.InvalidParameter):
                hp.trust(scene, **wrong)


def test_the_laboratory_measures():
    told = []
    fall = hp.lab_test("free-fall", "dry-sand", fall_m=0.05, body="Mars", progress=lambda what, share: told.append(share))
    assert abs(fall["acceleration_ratio"] - 1) < 1e-3 and told
    assert fall["findings"][0]["passes"] is True
    assert abs(fall["fallen_m"][-1] - 0.05) < 0.005
    with pytest.raises(hp.InvalidParameter, match="fall_m"):
        hp.lab_test("free-fall", "dry-sand", fall_n=1)
    with pytest.raises(hp.Stopped):
        hp.lab_test("shear", "dry-sand", progress=lambda what, share: False)
    with pytest.raises(hp.InvalidParameter):
        hp.calibrate(80, 0, 1500)
    with pytest.raises(hp.Stopped):
        hp.calibrate(40, 300, 1500, progress=lambda what, share: False)


class Presses(hp.Device):
    """Goes down into the soil and feels it."""

    limits = hp.Limits(simulated=1, max_force_n=12)

    def __init__(self):
        self.ticks, self.strongest_n, self.broken_at = 0, 0.0, 10**9

    def read(self):
        self.ticks += 1
        if self.ticks > self.broken_at:
            raise RuntimeError("a wire is loose")
        return hp.DeviceInput(position_m=(0, 0, -min(1e-4 * self.ticks, 0.1)), linear_m_s=(0, 0, -0.1))

    def write(self, force_n, torque_nm):
        self.strongest_n = max(self.strongest_n, float(force_n[2]))


class Sweeps(hp.Device):
    """Goes along the scene's x, 15 mm below the surface; the scene's axes are its own turned by `turn_rad` about z."""

    def __init__(self, turn_rad, declared_rad):
        self.limits = hp.Limits(simulated=1, turn_rad=(0, 0, declared_rad))
        self.along = np.array([np.cos(turn_rad), -np.sin(turn_rad), 0])
        self.ticks, self.last_n = 0, np.zeros(3)

    def read(self):
        self.ticks += 1
        return hp.DeviceInput(position_m=(6e-5 * self.ticks - 0.012) * self.along, linear_m_s=0.06 * self.along)

    def write(self, force_n, torque_nm):
        self.last_n = force_n


@pytest.mark.parametrize("mapping_deg", [0, 90, 180])
@pytest.mark.parametrize("declared_deg", [0, -90])
def test_each_wrench_has_one_frame(mapping_deg, declared_deg):
    with hp.Scene.from_toml(ICRA2021, mapping__offset_mm=[0, 0, -15], mapping__turn_deg=[0, 0, mapping_deg]) as scene:
        device = Sweeps(np.radians(mapping_deg + declared_deg), np.radians(declared_deg))
        with hp.Loop(scene, device, ticked_by_caller=True, keep_ticks=True) as loop:
            assert all(loop.tick() for _ in range(384))
            now, ticks, sent_n = loop.snapshot(), loop.take_ticks(), device.last_n
    across = np.cross([0, 0, 1], device.along)
    soil_n, felt_n = (ticks[name]["force_n"][200:].mean(axis=0) for name in ("soil_wrench", "device_wrench"))
    assert soil_n[0] < -0.1
    felt_in_scene_n = [felt_n @ device.along, felt_n @ across, felt_n[2]]
    assert np.allclose(felt_in_scene_n, soil_n, atol=0.25 * np.linalg.norm(soil_n))
    assert np.allclose([now.felt_n @ [1, 0, 0], now.felt_n @ [0, 1, 0]],
                       [now.device_force_n @ device.along, now.device_force_n @ across], atol=1e-12)
    assert np.array_equal(ticks["device_wrench"]["force_n"][-1], sent_n)
    tick = np.flatnonzero((ticks["soil"]["force_n"] == now.soil_force_n).all(axis=1))[-1]
    assert np.array_equal(ticks["felt"]["force_n"][tick], now.device_force_n)
    assert np.array_equal(ticks["device_wrench"]["torque_nm"][tick], now.device_torque_nm)
    assert np.array_equal(ticks["soil_wrench"]["torque_nm"][tick], now.soil_torque_nm)
    assert all(hp.Trip(trip) == hp.Trip.NONE for trip in ticks["trip"])


def test_a_device_in_python_feels_the_soil():
    with hp.Scene.from_toml(ICRA2021) as scene:
        device = Presses()
        with hp.Loop(scene, device, ticked_by_caller=True, keep_ticks=True) as loop:
            with pytest.raises(hp.Busy):
                scene.step([0, 0, 0.1])
            assert all(loop.tick() for _ in range(1200))
            assert device.ticks == 1200 and device.strongest_n > 0.1
            ticks = loop.take_ticks()
            assert len(ticks) == 1200 and ticks["felt"]["force_n"][:, 2].max() == device.strongest_n
            assert loop.snapshot().positions.shape == (256, 3)
            device.broken_at = 0
            with pytest.raises(RuntimeError, match="loose"):
                loop.tick()
            assert not loop.tick()
            assert loop.snapshot().end
        scene.step([0, 0, 0.2])


def test_the_scenes_own_hand_runs_on_a_thread():
    with hp.Scene.from_toml(ICRA2021, loop__real_time=False, loop__duration_s=0.5) as scene, hp.Loop(scene) as loop:
        loop.start()
        until = time.monotonic() + 30
        while loop.snapshot().running and time.monotonic() < until:
            time.sleep(0.01)
        now = loop.snapshot()
        assert now.misses_too_long + now.misses_woken_late + now.misses_preempted == now.deadline_misses
        assert not loop.snapshot().running and abs(loop.snapshot().time_s - 0.5) < 0.02
    with pytest.raises(TypeError, match="max_force"):
        hp.Limits(max_force=3)


def test_safety_limits_and_lets_go():
    safety = hp.Safety(hp.Limits(max_force_n=2), soft_start_s=0.1)
    assert safety.step([0, 0, 0], [0, 0, 50]).force_n[2] < 0.1
    for _ in range(300):
        felt = safety.step([0, 0, 0], [0, 0, 50])
    assert abs(felt.force_n[2] - 2) < 1e-9 and safety.info.trip == ""
    assert safety.step([0, 0, 0.05], [0, 0, 50]).force_n[2] == 0
    assert safety.info.trips == 1 and safety.info.trip
    with pytest.raises(hp.InvalidParameter):
        hp.Safety(soft_start_s=-1)


def episode(seed):
    env = DigEnv("icra2021", most_steps=15)
    random = np.random.default_rng(seed)
    seen, rewards = [env.reset(seed=seed)[0]], []
    truncated = False
    while not truncated:
        observation, reward, terminated, truncated, info = env.step([*random.uniform(-1, 1, 2), -1 if len(rewards) < 8 else 1])
        assert not terminated and "lifted_kg" in info
        seen.append(observation)
        rewards.append(reward)
    env.close()
    return seen, rewards


def test_the_same_seed_is_the_same_episode():
    seen, rewards = episode(3)
    again, rewards_again = episode(3)
    other, _ = episode(4)
    assert rewards == rewards_again and len(rewards) == 15
    for a, b in zip(seen, again):
        assert all(np.array_equal(a[name], b[name]) for name in a)
    assert not np.array_equal(seen[-1]["heights"], other[-1]["heights"])
    assert np.abs(seen[-1]["heights"] - seen[0]["heights"]).max() > 0.002, "nothing was dug"


def test_spaces_hold_what_comes():
    env = DigEnv("icra2021")
    observation, _ = env.reset(seed=1)
    for name, space in env.observation_space.items():
        assert space.contains(observation[name]), name
    assert env.action_space.contains(env.action_space.sample())
    for wrong in ([1, 2], [0, 0, np.nan], "up"):
        with pytest.raises(ValueError):
            env.step(wrong)
    env.close()


def test_many_environments_are_one_by_one():
    many = VecDigEnv(3, "icra2021", threads=2, most_steps=5)
    one = DigEnv("icra2021", most_steps=5)
    many.reset(seed=10)
    one.reset(seed=11)
    actions = np.random.default_rng(0).uniform(-1, 1, (5, 3, 3))
    for action in actions:
        observations, rewards, terminated, truncated, _ = many.step(action)
        observation, reward, _, ended, _ = one.step(action[1])
        assert np.array_equal(observations["heights"][1], observation["heights"]) and rewards[1] == reward
        assert truncated[1] == ended
    assert truncated.all()
    observations, rewards, _, truncated, _ = many.step(actions[0])
    assert not truncated.any() and not rewards.any() and many.metadata["autoreset_mode"]
    many.close()
    one.close()


def test_environments_in_threads():
    outcomes = []

    def dig(seed):
        outcomes.append((seed, episode(seed)[1]))

    threads = [threading.Thread(target=dig, args=(seed,)) for seed in (3, 3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert outcomes[0] == outcomes[1]


def test_a_psychometric_fit_is_the_programs(tmp_path):
    x, k = [0.6, 0.7, 0.8, 0.9, 1.0, 1.1], [3, 6, 9, 12, 15, 18]
    table = tmp_path / "answers.csv"
    table.write_text("x,k,n\n" + "".join(f"{a},{b},20\n" for a, b in zip(x, k)))
    program = Path(os.environ["HAPTOLITH_BUILD"]) / "apps/haptolith/haptolith"
    told = json.loads(subprocess.run([program, "study", "fit", "--data", table, "--reference", "0.835", "--json"], check=True,
                                     capture_output=True, text=True).stdout)
    fit = hp.fit_psychometric(x, k, 20, reference=0.835)
    assert {name: fit[name] for name in told} == told
    assert fit.columns["psi"].shape == (101,) and np.all(np.diff(fit["psi"]) > 0)
    trials = np.repeat(x, 20)
    answers = np.concatenate([np.arange(20) < yes for yes in k])
    assert hp.fit_psychometric(trials, answers, 1, reference=0.835)["w"] == fit["w"]
    with pytest.raises(hp.InvalidParameter, match="norm or logistic"):
        hp.fit_psychometric(x, k, 20, sigmoid="steep")
