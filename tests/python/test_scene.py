import copy
import gc
import os
import pickle
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import haptolith as hp
from conftest import CONTACT, ICRA2021, stirring


def test_version_and_lists():
    assert hp.__version__.count(".") == 2
    assert "regolith" in hp.scenes() and "dry-sand" in hp.soils() and hp.presets() == ["P1", "P2", "P3", "P4", "P5", "P6"]


def test_a_step_is_a_step_of_steps(scene):
    with scene.clone() as other:
        felt = scene.steps(stirring(0, 400))
        one_by_one = np.array([other.step(pose).numbers for pose in stirring(0, 400)])
        assert np.array_equal(felt, one_by_one)
        assert np.abs(felt[:, 2]).max() > 0.1
        assert other.state_hash == scene.state_hash


@pytest.mark.parametrize("how", ["pickle", "deepcopy", "copy", "clone", "state"])
def test_copies_go_on_with_the_same_bits(scene, how):
    scene.steps(stirring(0, 400))
    other = {"pickle": lambda: pickle.loads(pickle.dumps(scene)), "deepcopy": lambda: copy.deepcopy(scene),
             "copy": lambda: copy.copy(scene), "clone": scene.clone,
             "state": lambda: hp.Scene.from_state(scene.state)}[how]()
    assert other.state == scene.state
    for tick in range(400, 1400, 100):
        assert np.array_equal(scene.steps(stirring(tick, tick + 100)), other.steps(stirring(tick, tick + 100)))
        assert scene.state_hash == other.state_hash


def test_a_state_can_be_set_again_and_again(scene):
    start = scene.state
    felt = scene.steps(stirring(0, 300))
    for _ in range(3):
        scene.state = start
        assert np.array_equal(scene.steps(stirring(0, 300)), felt)
    with pytest.raises(hp.HaptolithError):
        scene.state = start[:-1]
    with hp.Scene.from_toml(ICRA2021, bed__particles=200) as other, pytest.raises(hp.InvalidParameter):
        other.state = start


def test_views_show_where_particles_are(scene):
    scene.steps(stirring(0, 300))
    before = scene.positions
    assert before.dtype == np.float32 and before.shape == (scene.info.particles, 3)
    kept = before.copy()
    with pytest.raises(ValueError):
        before[0, 0] = 1
    scene.steps(stirring(300, 500))
    assert not np.array_equal(scene.positions, kept)
    assert np.abs(scene.velocities).max() > 0
    assert abs(float(scene.radii.mean()) - scene.info.radius_m) < 0.05 * scene.info.radius_m
    assert scene.asleep.shape == scene.held.shape == scene.contact_loads.shape == (scene.info.particles,)


def test_a_view_outlives_its_scene():
    scene = hp.Scene.from_toml(ICRA2021)
    view = scene.positions
    kept = view.copy()
    scene.close()
    del scene
    gc.collect()
    assert np.array_equal(view, kept)


def test_checked_views_are_copies(monkeypatch):
    monkeypatch.setenv("HAPTOLITH_CHECK_VIEWS", "1")
    with hp.Scene.from_toml(ICRA2021) as scene:
        before = scene.positions
        kept = before.copy()
        scene.steps(stirring(0, 300))
        assert np.array_equal(before, kept)


def test_poses_may_be_given_in_several_ways():
    with hp.Scene.from_toml(ICRA2021) as scene:
        half = np.sqrt(0.5)
        matrix = np.eye(4)
        matrix[:3, :3] = [[0, -1, 0], [1, 0, 0], [0, 0, 1]]  # a quarter turn about z
        matrix[:3, 3] = [0.01, 0.02, 0.2]
        for pose in (matrix, [0.01, 0.02, 0.2, half, 0, 0, half], hp.Pose([0.01, 0.02, 0.2], [half, 0, 0, half])):
            scene.step(pose)
            assert np.allclose(scene.tool_pose, [0.01, 0.02, 0.2, half, 0, 0, half])
        scene.step([0, 0, 0.2])
        assert np.allclose(scene.tool_pose, [0, 0, 0.2, 1, 0, 0, 0])
        random = np.random.default_rng(1)
        for _ in range(200):
            q = random.normal(size=4)
            w, x, y, z = q / np.linalg.norm(q)
            matrix[:3, :3] = [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                              [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                              [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]]
            scene.place_tool(matrix)
            turned = scene.tool_pose[3:]
            assert np.allclose(turned * np.sign(turned @ [w, x, y, z]), [w, x, y, z])
        for wrong in ([1, 2], np.zeros((4, 4)), np.diag([1.0, 1, -1, 1])):
            with pytest.raises(ValueError):
                scene.step(wrong)
        with pytest.raises(hp.InvalidParameter):
            scene.step([0, 0, np.nan])
        with pytest.raises(ValueError):
            scene.step([0, 0, 0.2], twist=[1, 2, 3])


def test_wrong_keys_say_what_would_be_right():
    with pytest.raises(hp.InvalidParameter) as raised:
        hp.Scene("icra2021", bed__threads=0)
    assert (raised.value.key, raised.value.value, raised.value.valid) == ("bed.threads", "0", "a whole number, 1 to 256")
    assert isinstance(raised.value, ValueError)
    assert str(pickle.loads(pickle.dumps(raised.value))) == str(raised.value)
    with pytest.raises(hp.InvalidParameter, match="did you mean"):
        hp.Scene("sandbax")
    with pytest.raises(TypeError):
        hp.Scene("icra2021", bed__threads=object())
    with pytest.raises(hp.InvalidParameter):
        hp.Scene("icra2021", soil__preset='P3"\nx = "')


def test_changes_and_numbers():
    with hp.Scene.from_toml(CONTACT) as scene:
        scene.change(gravity__body="Mars", tool__size_mm=[30, 30, 4])
        assert abs(scene.info.gravity_m_s2[2] + 3.71) < 0.02
        scene.set_gravity([0, 0, -2])
        assert scene.info.gravity_m_s2 == (0, 0, -2)
        assert "size_mm = [30" in scene.toml
        with hp.Scene.from_toml(scene.toml) as again:
            assert again.info.particles == scene.info.particles
        scene.steps(stirring(0, 700))
        assert scene.contact_stiffness.shape == (3, 3) and scene.contact_stiffness[2, 2] > 0
        assert np.array_equal(scene.wrench.numbers[:3], scene.wrench.force_n)
        with pytest.raises(hp.InvalidParameter, match="another scene"):
            scene.change(bed__width_mm=200)


def test_a_closed_scene_says_so():
    scene = hp.Scene.from_toml(ICRA2021)
    scene.close()
    scene.close()
    for use in (lambda: scene.step([0, 0, 0.1]), lambda: scene.state, lambda: scene.positions, lambda: scene.info):
        with pytest.raises(hp.HaptolithError, match="closed"):
            use()
    assert "closed" in repr(scene)


def test_objects_say_what_they_are(scene):
    assert scene.soil in ("P3", "lunar-0-15cm") and scene.body == "Moon"
    assert f"{scene.soil}, Moon, {scene.info.particles} particles of R = 7 mm" in repr(scene)
    scene.set_gravity([0, 0, -2])
    with hp.Batch([scene]) as batch:
        assert repr(batch) == "<haptolith.Batch of 1 scenes>"
    fit = hp.fit_psychometric([1, 2, 3, 4, 5], [1, 3, 5, 8, 10], [10] * 5)
    assert repr(fit).startswith("<haptolith.Result: ") and len(repr(fit)) < 3000


def test_a_pose_that_is_not_finite_is_named(scene):
    with pytest.raises(hp.InvalidParameter, match="pose, z = nan is not valid: must be finite"):
        scene.step([0, 0, np.nan])
    poses = stirring(0, 3)
    poses[1, 0] = np.inf
    with pytest.raises(hp.InvalidParameter, match="pose 1, x = inf"):
        scene.steps(poses)


def test_an_interactive_session_sees_that_soil_settles(monkeypatch, capsys):
    from haptolith import _long

    line = _long.ProgressLine()
    line("soil settles", 0.1)
    line._next = 0
    line("soil settles", 0.5)
    line.end()
    assert "soil settles: 50 %" in capsys.readouterr().err


def test_progress_is_told_and_may_give_up_or_raise():
    told = []
    hp.Scene.from_toml("[bed]\nstart = 'rain'\nparticles = 300\n", progress=lambda what, share: told.append(what)).close()
    assert told and set(told) == {"soil settles"}
    with pytest.raises(hp.Stopped):
        hp.Scene.from_toml("[bed]\nstart = 'rain'\nparticles = 300\n", progress=lambda what, share: False)

    def broken(what, share):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        hp.Scene.from_toml("[bed]\nstart = 'rain'\nparticles = 300\n", progress=broken)


def test_ctrl_c_ends_long_work():
    code = ("import haptolith as hp\nprint('ready', flush=True)\n"
            "hp.Scene.from_toml(\"[bed]\\nstart = 'rain'\\nparticles = 60000\\nwidth_mm = 600\\nlength_mm = 600\\n\")\n")
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, env=os.environ)
    assert child.stdout.readline() == b"ready\n"
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    _, errors = child.communicate(timeout=30)
    assert b"KeyboardInterrupt" in errors


def test_other_threads_run_during_steps():
    with hp.Scene.from_toml(CONTACT) as scene:
        poses = stirring(0, 3000)
        begin = time.perf_counter()
        counted = []

        def count():
            n = 0
            while not done.is_set():
                n += 1
            counted.append(n)

        done = threading.Event()
        counter = threading.Thread(target=count)
        counter.start()
        scene.steps(poses)
        done.set()
        counter.join()
        took = time.perf_counter() - begin
        assert counted[0] > 1000 * took, "nobody counted while the soil moved"


def test_one_scene_in_two_threads_is_busy_or_fine():
    with hp.Scene.from_toml(ICRA2021) as scene:
        outcomes = []

        def use():
            for pose in stirring(0, 200):
                try:
                    scene.step(pose)
                    outcomes.append("ok")
                except hp.Busy:
                    outcomes.append("busy")

        threads = [threading.Thread(target=use) for _ in range(3)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert len(outcomes) == 600 and "ok" in outcomes
