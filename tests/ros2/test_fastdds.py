# SPDX-License-Identifier: Apache-2.0
"""The middleware `dds` as seen by Fast DDS, the default of ROS 2 Jazzy."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.ros2.build import Build
from tests.ros2.network import network, running

PEER = Path(__file__).resolve().parents[1] / "doubles" / "fastdds_peer"
FLOAT64, BOOL = (
    "std_msgs::msg::dds_::Float64_ typehash=RIHS01_705ba9c3d1a09df43737eb67095534de36fd426c0587779bda2bc51fe790182a;",
    "std_msgs::msg::dds_::Bool_ typehash=RIHS01_feb91e995ff9ebd09c0cb3d2aed18b11077585839fb5db80193b62d74528f6c9;",
)


@pytest.fixture(scope="session")
def fastdds_peer(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if not Path("/usr/include/fastdds").is_dir():
        pytest.skip("Fast DDS is not installed: sudo apt install libfastrtps-dev libfastcdr-dev")
    if not shutil.which("c++"):
        pytest.skip("g++ is not installed: sudo apt install g++")
    folder = tmp_path_factory.mktemp("fastdds_peer")
    for command in (
        ["cmake", "-S", str(PEER), "-B", str(folder), "-G", "Ninja"],
        ["cmake", "--build", str(folder)],
    ):
        done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=600)
        assert done.returncode == 0, done.stdout + done.stderr
    return folder / "fastdds_peer"


def test_fast_dds_hears_positions_sends_setpoints_and_sees_the_node(
    fastdds_peer: Path, build: Build, tmp_path: Path
) -> None:
    domain = 100 + os.getpid() % 100
    program, trace = build("jiwy"), tmp_path / "trace.csv"
    topics = ["reader", "rt/robot_7/pan_publisher", "best_effort_reader", "rt/robot_7/tilt_publisher"]
    topics += ["writer", "rt/robot_7/pan_subscriber", "best_effort_writer", "rt/robot_7/tilt_subscriber"]
    topics += ["reader", "rt/robot_7/tilt_publisher"]  # this one offers best effort only
    with network(domain, tagged=False) as net:
        robot = net.run(program, "--quiet", "--serial", "7", "--duration", "60", "--trace", str(trace))
        with running([robot]):
            done = subprocess.run(
                [str(fastdds_peer), str(domain), "4", *topics],
                env=net.environment,
                capture_output=True,
                text=True,
                check=False,
                timeout=60,
            )
            robot.terminate()
            _, errors = robot.communicate(timeout=30)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    heard = [line.split() for line in lines if line.startswith("heard ")]
    assert [topic for _, topic, *_ in heard] == [topics[1], topics[3], topics[3]]
    assert int(heard[0][2]) > 60 and int(heard[1][2]) > 60
    assert heard[2][2] == "0"
    assert "warning: a subscription of /robot_7/tilt_publisher requests another reliability" in errors
    matched = [line for line in lines if line.startswith("matched ")]
    assert matched[2:4] == [f"matched {topics[5]} 1", f"matched {topics[7]} 1"]
    last = trace.read_text().splitlines()[-1].split(",")
    header = trace.read_text().splitlines()[0].split(",")
    for axis in ("pan", "tilt"):
        assert float(last[header.index(f"inputs.setpoint_{axis}")]) == 0.25
        assert f"discovered writer rt/robot_7/{axis}_publisher {FLOAT64}" in lines
        assert f"discovered reader rt/robot_7/{axis}_subscriber {FLOAT64}" in lines
    assert f"discovered reader rt/robot_7/JIWY_node/enable {BOOL}" in lines
    info = bytes.fromhex(lines[-1].removeprefix("discovery_info "))
    assert b"/robot_7\0" in info and b"JIWY_node\0" in info
    topics_and_services = (3 + 3) + 1 + 2 * (6 + 3)  # /parameter_events; six services of parameters, three of the node
    assert info.count(info[:12]) == 1 + topics_and_services  # the identifiers of endpoints begin with the participant's
