# SPDX-License-Identifier: Apache-2.0
"""The Pico's image in the emulator, on a real agent, moved and tuned by ROS 2 itself.

The emulator is slower than the chip.  Times of the control loop are those of the emulated chip; ROS 2 and the agent run
in real time.
"""

from __future__ import annotations

import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles.xrce_agent.real_agent import RealAgent, free_domain
from tests.platforms.pico.images import skip_unless_emulated
from tests.platforms.pico.xrce.agent import BoardAgent
from tests.platforms.pico.xrce.board import Jiwy
from tests.platforms.pico.xrce.checks import assert_undisturbed
from tests.platforms.pico.xrce.line import Line
from tests.ros2.test_ros2_agent import GRAPH_AGENT, environment, graph_agent, node_script

LONGEST = 60_000.0  # ms of the emulated chip


class LiveJiwy(Jiwy):
    """A board that is connected to an agent outside the emulator."""

    def connect(self) -> BoardAgent:
        return Line(self.pico)  # type: ignore[return-value]

    @property
    def path(self) -> str:
        """The serial port for the agent."""
        return str(self.agent.path)  # type: ignore[attr-defined]


@pytest.fixture
def live(tmp_path: Path) -> Iterator[tuple[LiveJiwy, RealAgent]]:
    skip_unless_emulated("bare_metal")
    program = graph_agent()
    with LiveJiwy("bare_metal") as jiwy:
        device = ["serial", "-b", "115200", "--dev", jiwy.path]
        with RealAgent(device, free_domain(), tmp_path, program) as agent:
            yield jiwy, agent


MOVE = """
angle = float(sys.argv[1])
heard = []
node.create_subscription(Float64, "/pan_publisher", heard.append, qos_profile_sensor_data)
setpoint = node.create_publisher(Float64, "/pan_subscriber", qos_profile_sensor_data)
assert wait(lambda: len(heard) > 3 and setpoint.get_subscription_count() == 1, 60) is not None, nodes()

def follow():
    setpoint.publish(Float64(data=angle))
    return abs(heard[-1].data - angle) < 0.03

moved = wait(follow, 60)
print(json.dumps({"nodes": nodes(), "moved": moved, "position": heard[-1].data}))
"""


def finish(jiwy: LiveJiwy, process: subprocess.Popen[str]) -> str:
    """Lets the chip run until the process has ended; returns its output."""
    if not jiwy.agent.run_until(lambda: process.poll() is not None, LONGEST):
        process.send_signal(signal.SIGKILL)
    output, errors = process.communicate(timeout=30)
    assert process.returncode == 0, output + errors
    return output


@pytest.mark.parametrize("implementation", ["rmw_cyclonedds_cpp", "rmw_fastrtps_cpp"])
def test_ros_moves_the_image(live: tuple[LiveJiwy, RealAgent], implementation: str) -> None:
    jiwy, agent = live
    jiwy.home()
    jiwy.begin()
    told = finish(jiwy, node_script(agent, implementation, MOVE, 0.5))
    assert '"/JIWY_node"' in told and '"moved": null' not in told, told
    assert jiwy.angle("pan") == pytest.approx(0.5, abs=0.05)
    stats = assert_undisturbed(jiwy)
    assert (stats["malformed"], GRAPH_AGENT) == ("0", agent.agent.name if agent.agent else "")


def ros2(jiwy: LiveJiwy, agent: RealAgent, *arguments: str) -> str:
    """The output of `ros2` with the RMW that crosses agents, without its daemon."""
    command = ["ros2", *arguments, "--no-daemon", "--spin-time", "5"]
    told = environment(agent, "rmw_fastrtps_cpp")
    return finish(jiwy, subprocess.Popen(command, env=told, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True))


def test_ros_tunes_the_image(live: tuple[LiveJiwy, RealAgent]) -> None:
    jiwy, agent = live
    jiwy.home()
    jiwy.begin()
    assert "Pan.PID.kp" in ros2(jiwy, agent, "param", "list", "/JIWY_node")
    assert "successful" in ros2(jiwy, agent, "param", "set", "/JIWY_node", "Pan.PID.kp", "3.5")
    assert "3.5" in ros2(jiwy, agent, "param", "get", "/JIWY_node", "Pan.PID.kp")
    stats = assert_undisturbed(jiwy)
    assert (stats["malformed"], stats["reconnects"]) == ("0", "0")
