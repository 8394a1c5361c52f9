"""Scenes with several tools, and what the package's objects print."""

import pickle

import numpy as np
import pytest

import haptolith as hp
from conftest import CONTACT, ICRA2021, stirring
from haptolith import gym, recording

BOX = "[bed]\nstart = 'packed'\nwidth_mm = 300\nlength_mm = 100\ndepth_mm = 50\n"
TWO = (BOX + "[[tools]]\nname = 'left'\n[[tools]]\nname = 'wheel'\nshape = 'cylinder'\njoint_drive = 'speed'\n"
       "joint_axis = [0, 0, 1]\njoint_speed_rad_s = 3\n")


def both_stirring(first: int, last: int, apart_m: float = 0.1) -> np.ndarray:
    """(ticks, 2, 7): two tools that dig in circles."""
    one = stirring(first, last)
    other = stirring(first + 100, last + 100)
    one[:, 0] -= apart_m / 2
    other[:, 0] += apart_m / 2
    return np.stack([one, other], axis=1)


@pytest.fixture
def two():
    with hp.Scene.from_toml(TWO) as made:
        yield made


def test_poses_of_all_tools_give_a_wrench_each(two):
    assert two.tools.names == ["left", "wheel"] and len(two.tools) == 2
    with two.clone() as other:
        felt = two.steps(both_stirring(0, 400))
        assert felt.shape == (400, 2, 6)
        one_by_one = np.array([other.step(poses) for poses in both_stirring(0, 400)])
        assert np.array_equal(felt, one_by_one)
        assert np.abs(felt[:, 0, 2]).max() > 0.1 and np.abs(felt[:, 1, 2]).max() > 0.1
        assert other.state_hash == two.state_hash
        for i, tool in enumerate(two.tools):
            assert np.array_equal(tool.wrench.numbers, felt[-1, i])
            assert np.array_equal(tool.pose, both_stirring(399, 400)[0, i])
        listed = [hp.Pose(poses[:3], poses[3:]) for poses in both_stirring(400, 401)[0]]
        assert np.array_equal(two.step(listed), other.step(both_stirring(400, 401)[0].tolist()))
        moving = np.zeros((2, 6))
        assert other.step(both_stirring(401, 402)[0], moving).shape == (2, 6)


def test_one_tool_is_a_tool_too():
    with hp.Scene.from_toml(ICRA2021) as one, one.clone() as again:
        felt = one.steps(stirring(0, 300)[:, None, :])
        assert np.array_equal(felt[:, 0], again.steps(stirring(0, 300)))
        assert np.array_equal(one.step(stirring(300, 301)), [again.step(stirring(300, 301)[0]).numbers])
        assert one.tools["tool"].joint is None


def test_far_apart_each_feels_what_it_feels_alone():
    ball = "[[tools]]\nname = 'ball'\nshape = 'sphere'\ndiameter_mm = 30\n"
    shovel = "[[tools]]\nname = 'shovel'\n"
    wide = BOX.replace("300", "1400")
    scenes = [hp.Scene.from_toml(wide + tools) for tools in (shovel, ball, shovel + ball)]
    info = scenes[0].info
    ticks = int(1.0 / (2.5 * info.radius_m) / info.substeps)  # that a disturbance takes from one to the other
    poses = np.zeros((ticks, 2, 7))
    poses[:, :, 3] = 1
    poses[:, 0, 0], poses[:, 1, 0] = -0.6, 0.6
    poses[:, :, 2] = info.surface_m + 0.02 - 0.001 * np.arange(ticks)[:, None]
    for scene in scenes[:2]:
        scene.place_tool(poses[0, scenes.index(scene)])
    for i, tool in enumerate(scenes[2].tools):
        tool.place(poses[0, i])
    both = scenes[2].steps(poses)
    assert np.array_equal(both[:, 0], scenes[0].steps(poses[:, 0]))
    assert np.array_equal(both[:, 1], scenes[1].steps(poses[:, 1]))
    assert min(np.abs(both[:, i, 2]).max() for i in (0, 1)) > 0.01


def test_old_calls_are_for_the_first_tool(two):
    with hp.Scene.from_toml(BOX) as alone:
        surface_m = two.info.surface_m  # later on soil may fly
        felt = two.steps(stirring(0, 400))
        assert np.array_equal(felt, alone.steps(stirring(0, 400)))
        assert not two.tools["wheel"].in_soil and "not in the soil yet" in repr(two.tools["wheel"])
        assert np.array_equal(two.tool_pose, two.tools[0].pose)
        assert np.array_equal(two.contact_stiffness, two.tools["left"].contact_stiffness)
        two.tools["wheel"].place([0.1, 0, surface_m - 0.01])
        two.step([0, 0, 0.3])
        assert two.tools["wheel"].in_soil and two.tools["wheel"].wrench.force_n[2] > 0
        assert two.wrench.force_n[2] == 0


def test_joints_can_be_driven(two):
    wheel = two.tools["wheel"]
    two.steps(both_stirring(0, 300))
    joint = wheel.joint
    assert joint.drive == "speed" and joint.speed_rad_s == 3 and abs(joint.angle_rad - 0.9) < 1e-9
    assert joint.motor_torque_nm == -joint.soil_torque_nm != 0
    assert abs(wheel.turned_pose[6] - np.sin(0.45)) < 1e-9 and wheel.pose[6] == 0
    wheel.set_drive(-1)
    two.steps(both_stirring(300, 400))
    assert wheel.joint.speed_rad_s == -1 and abs(wheel.joint.angle_rad - 0.8) < 1e-9
    with pytest.raises(hp.InvalidParameter, match="drive of tool 'wheel' = 1000 is not valid: must be -100 to 100 rad/s"):
        wheel.set_drive(1000)
    with pytest.raises(hp.InvalidParameter, match="a tool whose joint_drive is speed or torque"):
        two.tools["left"].set_drive(1)
    wheel.set_fade(0.5)
    wheel.set_opening(0.5)
    assert wheel.fade == 0.5 and wheel.opening_m == 0 and wheel.grip_force == 0


def test_tools_are_changed_by_name(two):
    two.change(tools__wheel__diameter_mm=20, tools__left__friction=0.2)
    assert "diameter_mm = 20" in two.toml
    with pytest.raises(hp.InvalidParameter):
        two.change(tools__hoe__friction=0.2)
    with hp.Scene.from_toml(TWO, tools__left__hand__motion="press") as made:
        assert made.tools.names == ["left", "wheel"]


def test_wrong_poses_are_told_and_nothing_is_lost(two):
    two.steps(both_stirring(0, 100))
    before = two.state
    for wrong in (np.zeros((3, 7)), np.zeros((1, 7)), np.zeros((2, 6)), np.zeros((0, 7))):
        with pytest.raises(ValueError, match=r"poses of all 2 tools \(left, wheel\) are \(2, 7\)"):
            two.step(wrong)
    for wrong in (np.zeros((9, 3, 7)), np.zeros((9, 2, 3))):
        with pytest.raises(ValueError, match=r"\(ticks, 2, 7\)"):
            two.steps(wrong)
    poses = both_stirring(0, 5)
    with pytest.raises(ValueError, match=r"twists of 2 tools are \(2, 6\), not \(6,\)"):
        two.step(poses[0], np.zeros(6))
    poses[3, 1, 2] = np.nan
    with pytest.raises(hp.InvalidParameter, match="pose 1, z = nan"):
        two.step(poses[3])
    with pytest.raises(hp.InvalidParameter, match="pose 3 of tool 1, z = nan"):
        two.steps(poses)
    with pytest.raises(hp.InvalidParameter):
        two.step(both_stirring(0, 1)[0] + [0, 0, 50, 0, 0, 0, 0])
    with pytest.raises(KeyError, match="no tool 'hoe'; there are left, wheel"):
        two.tools["hoe"]
    with pytest.raises(IndexError):
        two.tools[2]
    assert two.state == before
    with pytest.raises(hp.InvalidParameter, match="must be at most 16"):
        hp.Scene.from_toml("".join(f"[[tools]]\nname = 't{i}'\n" for i in range(17)))
    with pytest.raises(hp.InvalidParameter, match="must be another name"):
        hp.Scene.from_toml("[[tools]]\nname = 'a'\n[[tools]]\nname = 'a'\n")


def test_copies_go_on_with_the_same_bits(two):
    two.steps(both_stirring(0, 200))
    start = two.state
    others = [pickle.loads(pickle.dumps(two)), two.clone(), hp.Scene.from_state(start)]
    felt = two.steps(both_stirring(200, 400))
    for other in others:
        assert other.tools.names == ["left", "wheel"]
        assert np.array_equal(other.steps(both_stirring(200, 400)), felt)
        assert other.state == two.state
    two.state = start
    assert np.array_equal(two.steps(both_stirring(200, 400)), felt)


def test_a_batch_steps_all_tools():
    scenes = [hp.Scene.from_toml(TWO, bed__seed=seed) for seed in (1, 2, 3)]
    apart = [scene.clone() for scene in scenes]
    poses = np.stack([both_stirring(50 * i, 50 * i + 200) for i in range(3)])
    with hp.Batch(scenes, threads=2) as batch:
        felt = batch.step(poses)
        assert felt.shape == (3, 200, 2, 6)
        assert np.array_equal(felt, [scene.steps(poses[i]) for i, scene in enumerate(apart)])
        assert [scene.state_hash for scene in scenes] == [scene.state_hash for scene in apart]
        with pytest.raises(ValueError, match=r"3 scenes with 2 tools are \(3, ticks, 2, 7\)"):
            batch.step(np.zeros((3, 9, 4, 7)))
        first = batch.step(poses[:, :, 0])
        assert first.shape == (3, 200, 6)
        assert repr(batch) == "<haptolith.Batch of 3 scenes with 2 tools>"


def test_the_first_of_several_tools_digs_in_an_environment():
    env = gym.DigEnv(hp.Scene.from_toml(TWO), most_steps=3)
    env.reset(seed=1)
    observation, *_ = env.step([0, 0, -1])
    assert observation["tool"].shape == (7,) and not env.episode.scene.tools[1].in_soil
    assert "tools left, wheel" in repr(env) and repr(env.episode).startswith("<haptolith.gym.Episode: 1 actions")


def test_objects_print_what_they_are(two, tmp_path):
    assert repr(two).endswith("friction, tools left, wheel>")
    assert repr(two.tools) == "<haptolith.Tools: left, wheel>"
    two.tools[0].place([0.01, 0, 0.2])
    assert repr(two.tools[0]) == "<haptolith.Tool 0 'left' at (10.0, 0.0, 200.0) mm>"
    assert "'wheel' at" in repr(two.tools[1]) and "speed joint at 0.0 deg" in repr(two.tools[1])
    assert repr(hp.Soil("P3")) == "<haptolith.Soil: preset P3 of icra2021>"
    soil = repr(hp.Soil("lunar-0-15cm"))
    assert soil.startswith("<haptolith.Soil: lunar-0-15cm, friction ") and " deg, cohesion " in soil and " kg/m3>" in soil
    with hp.Scene.from_toml(CONTACT) as scene:
        with hp.Loop(scene, ticked_by_caller=True, keep_ticks=True) as loop:
            assert "another thread or a loop is using" in repr(scene)
            recorder = recording.Recorder(loop, tmp_path / "run.h5")
            for _ in range(20):
                loop.tick()
            recorder.finish()
            assert repr(loop).startswith("<haptolith.Loop with the scene's device: running, 1")  # the last snapshot is older than tick 20
            snapshot = repr(loop.snapshot())
            assert snapshot.startswith("<haptolith.Snapshot: running, 0.0") and len(snapshot) < 300
            assert "run.h5: 20 ticks" in repr(recorder) and repr(recorder.info).startswith("RecorderInfo(ticks=20,")
            recorder.close()
        assert repr(loop) == "<haptolith.Loop, closed>"
    recorded = recording.Recording(tmp_path / "run.h5")
    assert ": 20 ticks, 0.02 s, " in repr(recorded)
    assert repr(hp.Safety()) == "<haptolith.Safety: force is on, 0 trips>"
    assert repr(hp.Device()) == "<Device 'device in Python'>"
    tool = two.tools[0]
    two.close()
    assert "has been closed" in repr(tool)
    with pytest.raises(hp.HaptolithError, match="closed"):
        tool.place([0, 0, 0.2])
    with pytest.raises(hp.HaptolithError, match="closed"):
        two.step(np.zeros((2, 7)) + [0, 0, 0.2, 1, 0, 0, 0])


class Pressing(hp.Device):
    """A hand that presses its tool into the soil at a place."""

    def __init__(self, x_m, name):
        self.name, self.x_m, self.ticks, self.force_n = name, x_m, 0, 0.0

    def read(self):
        self.ticks += 1
        return hp.DeviceInput(position_m=(self.x_m, 0, -0.06 - 0.04 * min(1, 0.005 * self.ticks)))

    def write(self, force_n, torque_nm):
        self.force_n = force_n[2]


def test_a_loop_moves_every_tool_and_its_recording_is_run_again(tmp_path):
    path = tmp_path / "two.h5"
    left, right = Pressing(-0.1, "left hand"), Pressing(0.1, "right hand")
    with hp.Scene.from_toml(TWO, loop__real_time=False) as scene:
        with hp.Loop(scene, [left, right], ticked_by_caller=True, keep_ticks=True) as loop, \
                recording.Recorder(loop, path) as recorder:
            assert "left hand, right hand" in repr(loop)
            for _ in range(400):
                assert loop.tick()
            recorder.take()
            assert left.force_n > 0 and right.force_n > 0
        with hp.Loop(scene, [left, None], ticked_by_caller=True, keep_ticks=True) as loop:
            for _ in range(10):
                assert loop.tick()
            assert list(loop.take_ticks()["tool"]) == [0, 1] * 10
        with pytest.raises(hp.HaptolithError, match="tool"):
            hp.Loop(scene, [left], ticked_by_caller=True)
    with recording.Recording(path) as read:
        verified = read.verify()
        assert verified.same and verified.ticks == 400
