# SPDX-License-Identifier: Apache-2.0
"""The use of topics: periods, newest values, timeouts of setpoints, enabling, diagnostics."""

from __future__ import annotations

import itertools
import statistics
from pathlib import Path

import pytest

from epg.live.client import Client, CommandRefused
from epg.live.port import SerialPort
from tests.doubles.xrce_agent import Agent

from .board import Board
from .checks import check_newest_setpoints, check_period, check_wrong_setpoints


def test_a_period_is_20_ms_and_of_one_control_cycle(board: Board) -> None:
    steps = check_period(board, error=0.3)
    assert statistics.median(steps) == 20


def test_every_cycle_is_published_once(complete_robot: Path, agent: Agent) -> None:
    """With ``keep_cycles``: reliable and best effort, although the communication runs less often than the control.

    Other topics may leave out a publication if this computer stops the program for longer than their period.
    """
    with Board(complete_robot, agent) as board:
        board.running()
        agent.wait_until(lambda: len(board.values("cycles")) > 1500)
        for topic, step in (("cycles", 1), ("cycles_too", 2)):
            values = board.values(topic)[1:]  # the first one follows the connection at once
            steps = [later - earlier for earlier, later in itertools.pairwise(values)]
            assert len(steps) > 700
            # Periods are of time.  If this computer makes the program miss a tick, one step is shorter.
            assert set(steps) <= {1, step}
            assert step == 1 or steps.count(1) <= board.statistic("missed")
        assert board.stop() == ""


def test_the_newest_setpoint_counts(board: Board) -> None:
    check_newest_setpoints(board)


def test_qos_of_peers(board: Board, agent: Agent) -> None:
    """As in ROS 2, a best-effort publisher does not match a reliable subscriber; a reliable one matches all."""
    assert board.set("reliable", 0.5, reliable=False) == 0
    assert board.set("quick", 0.5, reliable=True) == 1
    assert board.set("quick", 0.75, reliable=False) == 1
    board.wait_for("got_quick", 0.75)
    careful = agent.topics.subscribe("rt/lab/got_quick", reliable=True)
    default = agent.topics.subscribe("rt/lab/got_reliable", reliable=True)
    wrong = agent.topics.subscribe("rt/lab/got_reliable", type_name="std_msgs::msg::dds_::Float32_")
    agent.wait_until(lambda: len(default.samples) > 5)
    assert careful.samples == [] and wrong.samples == []
    assert board.values("got_reliable")[-1] == 0.25


def test_what_is_no_number_is_dropped_and_counted(board: Board) -> None:
    check_wrong_setpoints(board, [b"", b"\0" * 7])


def test_a_timeout_acts_as_declared_and_nothing_else_does(robot: Path, agent: Agent) -> None:
    """The board loses the agent: values without a timeout stay, and so does everything else."""
    with Board(robot, agent) as board:
        board.running()
        for topic in ("reliable", "quick", "held", "zeroed"):
            board.set(topic, 0.5)
        board.wait_for("got_zeroed", 0.5)
        agent.kill()
        board.lose()
        agent.start()
        board.running()
        since = agent.topics.count
        board.publishes(3)
        seen = {topic: set(board.values(f"got_{topic}", since)) for topic in ("reliable", "quick", "held", "zeroed")}
        assert seen == {"reliable": {0.5}, "quick": {0.5}, "held": {0.5}, "zeroed": {0.0}}
        diagnostics = board.diagnostics()
        assert diagnostics.values["setpoint_timeouts"] == "2"
        assert (diagnostics.level, diagnostics.values["faults"]) == ("WARN", "0")
        assert diagnostics.message.startswith("enabled") and "; setpoint timeouts" in diagnostics.message
        board.set("zeroed", 0.75)
        board.wait_for("got_zeroed", 0.75)
        assert board.stop() == ""


def test_a_timeout_that_disables_stays_until_somebody_enables(disabling_robot: Path, agent: Agent) -> None:
    """A reconnection does not clear the fault."""
    with Board(disabling_robot, agent) as board:
        board.running()
        board.set("zeroed", 0.5)
        board.wait_for("got_zeroed", 0.5)
        agent.kill()
        board.lose()
        agent.start()
        board.running()
        board.set("zeroed", 0.5)
        for _ in range(3):
            diagnostics = board.diagnostics()
            assert diagnostics.level == "ERROR"
            assert (diagnostics.values["fault"], diagnostics.values["component"]) == ("setpoint timeout", "zeroed")
        board.enable(True)
        agent.wait_until(lambda: board.diagnostics().state == "enabled")
        assert board.stop() == ""


def test_a_robot_that_ros_has_enabled_stays_so_beside_a_program(
    spoken_robot: Path, agent: Agent, tmp_path: Path
) -> None:
    """A program of `epg live` opens and closes the console; it cannot take the enabling over."""
    port = tmp_path / "port"
    with Board(spoken_robot, agent, "--console-pty", str(port)) as board:
        board.running()
        for on, state in ((False, "disabled"), (True, "enabled")):
            board.enable(on)
            agent.wait_until(lambda state=state: board.diagnostics().state == state)
        with SerialPort(port) as opened:
            client = Client(opened)
            with pytest.raises(CommandRefused, match="enabled already, without a lease"):
                client.enable()
            client.stop()
        assert {board.diagnostics().state for _ in range(5)} == {"enabled"}


def test_the_enable_topic(board: Board, agent: Agent) -> None:
    assert board.diagnostics().state == "enabled"
    board.enable(False)
    agent.wait_until(lambda: board.diagnostics().state == "disabled")
    assert board.diagnostics().message == "disabled"
    cycles = board.next("cycles")
    board.enable(True)
    agent.wait_until(lambda: board.diagnostics().state == "enabled")
    assert board.next("cycles") < cycles  # the model has been initialised


def test_diagnostics(robot: Path, agent: Agent) -> None:
    with Board(robot, agent, serial="C") as board:
        board.running()
        diagnostics = board.diagnostics()
        assert (diagnostics.name, diagnostics.hardware) == ("lab/robot_C", "C")
        numbers = {name: int(text) for name, text in diagnostics.values.items() if text.isdigit()}
        assert numbers.keys() >= {"cycles", "overruns", "missed", "lateness_max_ns", "computation_max_ns", "reconnects"}
        assert 0 < numbers["computation_min_ns"] <= numbers["computation_max_ns"]
        assert len(diagnostics.values["firmware"]) == 16
        stamps = [board.diagnostics().stamp for _ in range(6)]
        periods = [after - before for before, after in itertools.pairwise(stamps)]
        assert statistics.median(periods) == pytest.approx(0.2, abs=0.02)
        assert board.stop() == ""


def test_a_line_that_is_too_slow_drops_old_values(robot: Path, agent: Agent) -> None:
    """No frame is acknowledged for half a second: later messages have new values, and the loop has continued."""
    with Board(robot, agent) as board:
        board.running()
        agent.from_board.loss = 1.0
        agent.wait_until(lambda: sum(frame.fate == "lost" for frame in agent.log) > 30)
        agent.from_board.loss = 0.0
        board.publishes(50)
        assert len(agent.created) == 1
        agent.wait_until(lambda: board.values("cycles")[-1] in board.values("cycles_too")[-2:], 2.0)
        assert board.statistic("unsent") > 5
        assert board.stop() == ""
