# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware with micro-ROS is the same node as with xrce; only its own communication waits for the agent."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from integration.micro_ros.tests.pico.firmware import MicroRosJiwy
from tests.platforms.pico.xrce.board import CONSOLE_PORT
from tests.platforms.pico.xrce.checks import ENDS, assert_undisturbed
from tests.platforms.pico.xrce.scenarios import assert_holds, assert_is_back, hold, restart

HEAP = ("_malloc_r", "_sbrk")
SILENCE = 1000  # milliseconds after which micro_ros gives a silent agent up
"""Every use of the C library's heap calls this."""


@pytest.fixture(scope="module")
def board() -> Iterator[MicroRosJiwy]:
    with MicroRosJiwy() as made:
        for name in HEAP:
            made.pico.call("watch_span", name=name, core=0, **{"from": name, "to": "return"})
        made.home()
        yield made


@pytest.fixture
def jiwy(board: MicroRosJiwy) -> MicroRosJiwy:
    hold(board)
    return board


def test_it_is_the_node_that_xrce_is(board: MicroRosJiwy) -> None:
    ends = {end.topic: (end.type, end.reliable) for end in [*board.agent.topics.readers, *board.agent.topics.writers]}
    assert ends == ENDS


def test_the_agent_is_restarted(jiwy: MicroRosJiwy) -> None:
    """Positions arrive and setpoints act again; the memory is the target's own, and all of it is free again."""
    restart(jiwy, times=3)
    assert_is_back(jiwy)
    assert [name for name in HEAP if jiwy.pico.call("span", name=name)["passages"]] == []
    size = jiwy.pico.call("symbol", name="middleware_memory")["size"]
    most = jiwy.pico.word("arena", offset=8)
    assert 0.5 * size < most < 0.9 * size


def test_the_console_and_the_control_loop_go_on_while_it_waits(jiwy: MicroRosJiwy) -> None:
    """The agent is there but silent: every 0.2 s, a ping waits 20 ms for an answer."""
    jiwy.agent.freeze()
    jiwy.agent.run(SILENCE + 300)
    assert jiwy.stats()["connection"] == "waiting"
    answers = []
    for _ in range(20):
        jiwy.pico.receive(port=CONSOLE_PORT)
        jiwy.pico.send("\nversion\n", port=CONSOLE_PORT)
        begin = jiwy.agent.now()
        assert jiwy.agent.run_until(lambda: "ok version" in jiwy.pico.receive(port=CONSOLE_PORT), milliseconds=100)
        answers.append(1000 * (jiwy.agent.now() - begin))
        jiwy.agent.run(7)
    assert max(answers) < 12, "ms: sooner than a ping is over"
    assert_holds(jiwy)
    jiwy.agent.thaw()
    jiwy.agent.wait_for("rt/pan_publisher")
    assert_undisturbed(jiwy)
