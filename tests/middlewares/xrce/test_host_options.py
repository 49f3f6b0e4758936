# SPDX-License-Identifier: Apache-2.0
"""The address of the agent on the command line of a host executable, and the messages about it."""

from __future__ import annotations

import shutil
import struct
import subprocess
from pathlib import Path

import pytest

from tests.doubles.xrce_agent import Agent

from ..client import Host, stat

PATIENCE = 20.0


def run(program: Path, *options: str) -> tuple[int, str]:
    done = subprocess.run([program, *options], capture_output=True, text=True, check=False, timeout=PATIENCE)
    return done.returncode, done.stderr


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["--agent", "127.0.0.1:8888", "--duration", "1"], 2, "error: --agent without --realtime\n"),
        (["--serial-device", "/dev/null", "--duration", "1"], 2, "error: --serial-device without --realtime\n"),
        (["--realtime", "--agent", "127.0.0.1"], 2, "error: --agent '127.0.0.1' is not HOST:PORT\n"),
        (["--realtime", "--agent", "127.0.0.1:70000"], 2, "error: --agent '127.0.0.1:70000' is not HOST:PORT\n"),
        (["--realtime", "--agent", "a:1", "--serial-device", "b"], 2, "error: --agent and --serial-device\n"),
        (
            ["--realtime", "--agent", "no.such.host.invalid:1"],
            1,
            "error: the agent's host 'no.such.host.invalid' was not found",
        ),
        (["--realtime", "--console", "--duration", "1"], 2, "error: this target has no console\n"),
        (["--replay", "missing.csv"], 2, "missing.csv: error: "),
        (["--replay", "missing.csv", "--realtime"], 2, "error: --replay with another option than"),
    ],
)
def test_mistakes(robot: Path, options: list[str], status: int, message: str) -> None:
    found, errors = run(robot, *options)
    assert found == status and errors.startswith(message)


def test_a_serial_line_needs_its_terminal(spoken_robot: Path) -> None:
    status, errors = run(spoken_robot, "--realtime", "--duration", "1")
    assert status == 2 and errors.startswith("error: the serial device of the agent is not given\n")


def test_in_simulated_time_it_runs_without_an_agent(robot: Path) -> None:
    assert run(robot, "--duration", "0.5") == (0, "")


def test_it_says_whether_there_is_an_agent(robot: Path, agent: Agent) -> None:
    command = [str(robot), "--realtime", "--agent", agent.address]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        try:
            assert process.stderr.readline() == f"robot: connected to the agent at {agent.address}\n"
            agent.kill()
            assert process.stderr.readline() == f"robot: lost the agent at {agent.address}\n"
            agent.start()
            assert process.stderr.readline() == f"robot: connected to the agent at {agent.address}\n"
        finally:
            process.terminate()
        assert process.wait(PATIENCE) == 130


def start(program: Path, agent: Agent, *options: str) -> subprocess.Popen[str]:
    command = [str(program), "--realtime", "--agent", agent.address, *options]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)


def test_two_programs_with_one_name_have_two_sessions(robot: Path, agent: Agent, tmp_path: Path) -> None:
    """Their keys differ by the programs' files, and stay the same after a restart."""
    other = tmp_path / "robot_host"
    shutil.copy(robot, other)
    programs = [start(robot, agent), start(other, agent)]
    try:
        agent.wait_until(lambda: len(agent.clients) == 2, PATIENCE)
        told = len(agent.topics.samples("rt/diagnostics"))
        agent.wait_until(lambda: len(agent.topics.samples("rt/diagnostics")) >= told + 30)  # 3 s of both
        assert len(agent.created) == 2
        programs[1].kill()
        programs[1].wait()
        programs.append(start(other, agent))
        agent.wait_until(lambda: len(agent.created) == 3, PATIENCE)
        assert len({key for _, key in agent.created}) == 2
    finally:
        for process in programs:
            process.kill()
            process.communicate()


def test_a_second_copy_of_a_program_is_refused(robot: Path, agent: Agent) -> None:
    first = start(robot, agent)
    try:
        agent.wait_until(lambda: len(agent.clients) == 1, PATIENCE)
        status, errors = run(robot, "--realtime", "--duration", "5", "--agent", agent.address)
        assert (status, errors) == (
            1,
            f"error: this program already runs, as the node /lab/robot_host of the agent at {agent.address}\n"
            "hint: a second copy needs another name, for example --ros-args -r __ns:=/robot_2\n",
        )
        status, errors = run(
            robot, "--realtime", "--duration", "1", "--agent", agent.address, "--ros-args", "-r", "__ns:=/robot_2"
        )
        assert status == 0 and "error" not in errors
        assert len(agent.created) == 2
    finally:
        first.kill()
        first.communicate()
    status, errors = run(robot, "--realtime", "--duration", "1", "--agent", agent.address)
    assert status == 0 and "error" not in errors


def test_without_options_it_is_a_node(robot: Path, agent: Agent, tmp_path: Path) -> None:
    """`ros2 run PACKAGE robot_host` gives no options.  With files, the run is a simulation and needs its duration."""
    command = [str(robot), "--agent", agent.address]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        try:
            assert process.stderr.readline() == f"robot: connected to the agent at {agent.address}\n"
        finally:
            process.terminate()
        assert process.wait(PATIENCE) == 130
    status, errors = run(robot, "--trace", str(tmp_path / "trace.csv"))
    assert status == 2 and errors.startswith("error: --duration is missing\n")


def test_a_namespace_of_two_parts(robot: Path, agent: Agent) -> None:
    command = ["--realtime", "--duration", "1", "--agent", agent.address, "--ros-args", "-r"]
    status, errors = run(robot, *command, "__ns:=/fleet/robot_7")
    assert status == 0 and errors.startswith(
        "robot: 'ros2 node info' does not find this node: an agent takes '/fleet' for its namespace and "
        "'robot_7/robot_host' for its name; topics, services and parameters work\n"
    )
    status, errors = run(robot, *command, "__ns:=/fleet")
    assert status == 0 and "ros2 node info" not in errors


def test_simulated_time_at_a_pace_is_on_clock(robot: Path, agent: Agent) -> None:
    """The session lasts at ten times real time, which its time-outs follow."""
    command = [str(robot), "--pace", "10", "--agent", agent.address]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        try:
            note = "robot: simulated time at 10 times real time: this run is not repeatable\n"
            assert process.stderr.readline() == note
            assert process.stderr.readline() == f"robot: connected to the agent at {agent.address}\n"
            assert agent.topics.wait_until(lambda: len(agent.topics.samples("rt/clock")) > 300, PATIENCE)
            times = [struct.unpack("<iI", sample.data[-8:]) for sample in agent.topics.samples("rt/clock")]
            assert times == sorted(times) and times[-1][0] < 1000
            agent.topics.wait_for_sample("rt/lab/cycles_too", PATIENCE, "/lab/robot_host")
        finally:
            process.terminate()
        assert process.wait(PATIENCE) == 130
        assert process.stderr.read() == "", "the agent was never lost"


def test_the_console_beside_it_tells_of_the_connection(spoken_robot: Path, agent: Agent) -> None:
    with Host(spoken_robot, "--quiet", "--agent", agent.address) as host:
        agent.topics.wait_for_sample("rt/lab/cycles_too", PATIENCE, "/lab/robot_host")
        assert stat(host.ask("stats"), "connection") == "running"
        agent.kill()
        agent.wait_until(lambda: stat(host.ask("stats"), "connection") == "waiting", PATIENCE)
        assert host.ask("quick=0.5") == ["ok setpoint"]
