"""What goes over the network, as Wireshark's dissector of RTPS reads it: another reader of the specification than either DDS."""
import os
import shutil
import subprocess
import time

import pytest

HAPTOLITH = os.environ["HAPTOLITH"]
DOMAIN = str(1 + os.getpid() % 100)


def test_decodes(tmp_path):
    for program in ("dumpcap", "tshark"):
        if shutil.which(program) is None:
            pytest.skip(f"there is no {program}: apt-get install tshark")
    capture = str(tmp_path / "capture.pcapng")
    listener = subprocess.Popen(["dumpcap", "-q", "-i", "lo", "-a", "duration:6", "-w", capture], stderr=subprocess.PIPE, text=True)
    time.sleep(0.7)
    if listener.poll() is not None:
        pytest.skip("may not capture: " + listener.stderr.read())
    common = ["--localhost", "--domain", DOMAIN, "--json"]
    gateway = subprocess.Popen([HAPTOLITH, "teleop", "ros2", "--robot", "/haptolith", "--listen", "127.0.0.1:0", "--duration-s", "4", *common],
                               stdout=subprocess.DEVNULL)  # a reader: without readers nothing is sent
    scene = subprocess.run([HAPTOLITH, "ros2", "icra2021", "--motion", "stir", "--duration-s", "3", "--no-serve", *common],
                           stdout=subprocess.PIPE, text=True, timeout=60)
    assert scene.returncode == 0
    assert gateway.wait(timeout=20) == 0
    listener.wait(timeout=20)

    def field_rows(display_filter, *fields):
        command = ["tshark", "-r", capture, "-Y", display_filter, "-T", "fields"]
        for field in fields:
            command += ["-e", field]
        text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
        return [line.split("\t") for line in text.splitlines()]

    told = [row for row in field_rows("rtps.param.topicName && rtps.param.typeName", "rtps.param.topicName", "rtps.param.typeName")]
    types = {}
    for topics, names in told:
        types.update(zip(topics.split(","), names.split(",")))
    assert types["rt/haptolith/tool_pose"] == "geometry_msgs::msg::dds_::PoseStamped_"
    assert types["rt/haptolith/wrench"] == "geometry_msgs::msg::dds_::WrenchStamped_"
    assert types["rt/haptolith/surface"] == "sensor_msgs::msg::dds_::PointCloud2_"
    assert types["rt/haptolith/target_pose"] == "geometry_msgs::msg::dds_::PoseStamped_"
    assert types["rt/tf"] == "tf2_msgs::msg::dds_::TFMessage_"
    assert types["ros_discovery_info"] == "rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"

    poses = field_rows('rtps.issueData && rtps.param.topicName == "rt/haptolith/tool_pose"', "rtps.issueData", "rtps.param.serialize.encap_kind")
    assert len(poses) > 2000
    for data, kind in poses[:: len(poses) // 50]:
        assert int(kind, 16) == 1  # CDR_LE
        assert bytes.fromhex(data)[8:26] == b"\x0e\0\0\0haptolith_bed\0"
        assert len(bytes.fromhex(data)) == 88
