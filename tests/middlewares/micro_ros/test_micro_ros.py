# SPDX-License-Identifier: Apache-2.0
"""The middleware ``micro_ros``: topics in both directions, QoS, an agent that restarts, a serial line."""

from __future__ import annotations

import itertools
import statistics
import time
from pathlib import Path

import pytest

from tests.xrce_agent import Agent, PtyLink

from .conftest import Board

FLOAT64 = "std_msgs::msg::dds_::Float64_"


def check_alive(board: Board, value: float) -> None:
    """Both directions work: a setpoint reaches the model, and the model's answer comes back."""
    board.agent.wait_until(lambda: board.set("reliable", value) >= 1 and board.values("got_reliable")[-1:] == [value])


def test_node_and_topics_are_those_of_xrce(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        (client,) = agent.clients.values()
        ends = {(end.topic, end.type, end.reliable) for end in client.ends.values()}
        assert {end for end in ends if end[1] == FLOAT64} == {
            ("rt/lab/reliable", FLOAT64, True),
            ("rt/lab/quick", FLOAT64, False),
            ("rt/lab/held", FLOAT64, False),
            ("rt/lab/zeroed", FLOAT64, False),
            ("rt/lab/got_reliable", FLOAT64, True),
            ("rt/lab/got_quick", FLOAT64, False),
            ("rt/lab/got_held", FLOAT64, False),
            ("rt/lab/got_zeroed", FLOAT64, False),
            ("rt/lab/cycles", FLOAT64, True),
            ("rt/lab/cycles_too", FLOAT64, False),
        }
        assert ends - {end for end in ends if end[1] == FLOAT64} == {
            ("rt/diagnostics", "diagnostic_msgs::msg::dds_::DiagnosticArray_", True),
            ("rt/lab/robot_1/enable", "std_msgs::msg::dds_::Bool_", True),
        }
        check_alive(board, 0.5)
        assert board.stop() == ""
        agent.wait_until(lambda: agent.clients == {})  # the board has closed its session
        assert agent.malformed == 0


def test_a_period_is_20_ms_and_of_one_control_cycle(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        began = time.monotonic()
        time.sleep(2.0)
        reliable, quick = board.timed("cycles", began), board.timed("cycles_too", began)
        assert abs(len(quick) - 100) <= 5
        steps = [after[1] - before[1] for before, after in itertools.pairwise(quick)]
        assert statistics.mean(steps) == pytest.approx(20, abs=0.5)  # control cycles of 1 ms
        assert {value for _, value in reliable} >= {value for _, value in quick[1:-2]}
        assert board.stop() == ""


def test_the_newest_setpoint_counts(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        for topic in ("reliable", "quick"):
            for number in range(200):
                assert board.set(topic, 1.0 + number / 256) == 1
            board.wait_for(f"got_{topic}", 1.0 + 199 / 256)
            time.sleep(0.1)
            assert board.values(f"got_{topic}")[-1] == 1.0 + 199 / 256
        assert board.stop() == ""


def test_what_is_no_number_is_dropped_and_counted(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        board.set("reliable", 0.5)
        board.wait_for("got_reliable", 0.5)
        for value in (float("nan"), float("inf"), float("-inf")):
            board.set("reliable", value)
        for data in (b"\0" * 7, b"\0" * 600):
            board.topics.publish("rt/lab/quick", data)
        board.set("quick", 0.75)
        board.wait_for("got_quick", 0.75)
        agent.wait_until(lambda: board.statistic("setpoints_dropped") == 3)
        diagnostics = board.diagnostics()
        assert (diagnostics.values["malformed"], diagnostics.level) == ("2", "OK")
        assert board.stop() == ""


def test_the_enable_topic(robot: Path, agent: Agent) -> None:
    with Board(robot, agent) as board:
        board.running()
        assert board.diagnostics().level == "OK"
        board.enable(False)
        agent.wait_until(lambda: board.diagnostics().level == "WARN")
        board.enable(True)
        agent.wait_until(lambda: board.diagnostics().level == "OK")
        assert board.stop() == ""


def test_stamps_are_of_the_agents_clock(robot: Path, agent: Agent) -> None:
    agent.clock_offset = 1000.0
    with Board(robot, agent) as board:
        board.running()

        def error() -> float:
            return board.diagnostics().stamp - (time.time() + 1000.0)

        agent.wait_until(lambda: abs(error()) < 1.0)
        errors = [error() for _ in range(5)]
        # stamps are of the control cycle, so a little earlier
        assert all(-0.2 < each <= 0.02 for each in errors), errors
        assert board.stop() == ""


def test_the_board_is_there_first(robot: Path, agent: Agent) -> None:
    agent.kill()
    with Board(robot, agent) as board:
        time.sleep(1.0)
        agent.start()
        assert board.running() < 5.0
        check_alive(board, 0.5)
        assert board.next("cycles") > 1000  # the model has run meanwhile
        assert board.statistic("reconnects") == 0
        assert board.stop() == ""


@pytest.mark.parametrize("pause", [0.0, 2.0])
def test_the_agent_is_restarted(robot: Path, agent: Agent, pause: float) -> None:
    """Even a restart too fast for a timeout is detected.  The control loop is undisturbed, and memory does not grow."""
    with Board(robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        for number in range(1, 4):
            before_time, before = board.timed("cycles_too")[-1]
            agent.restart(pause)
            assert board.running() < 6.0
            after_time, after = board.timed("cycles_too")[-1]
            assert after - before == pytest.approx((after_time - before_time) * 1000, abs=60)
            assert board.next("got_reliable") == 0.5  # the board has kept its setpoint
            assert board.statistic("reconnects") == number
        check_alive(board, 0.75)
        assert board.stop() == ""  # AddressSanitizer has found no leak


def test_frames_that_are_lost_come_again(robot: Path, agent: Agent) -> None:
    """No frame arrives for half a second: reliable messages fill their stream, then the same session continues."""
    with Board(robot, agent) as board:
        board.running()
        agent.from_board.loss = 1.0
        time.sleep(0.5)
        agent.from_board.loss = 0.0
        time.sleep(1.5)
        assert len(agent.created) == 1
        when, cycles = board.timed("cycles")[-1]
        when_too, cycles_too = board.timed("cycles_too")[-1]
        assert cycles - cycles_too == pytest.approx((when - when_too) * 1000, abs=40)
        assert board.stop() == ""


def test_a_serial_line(serial_robot: Path, tmp_path: Path) -> None:
    with Agent(PtyLink(tmp_path / "line")) as agent, Board(serial_robot, agent) as board:
        board.running()
        check_alive(board, 0.5)
        agent.restart(0.5)
        board.running()
        check_alive(board, 0.75)
        assert board.stop() == ""
