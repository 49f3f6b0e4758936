# SPDX-License-Identifier: Apache-2.0
"""JIWY on the emulated STM32H743 as a ROS 2 node, with its agent at a UART by DMA."""

from __future__ import annotations

import itertools
import random
from collections.abc import Iterator

import pytest

from tests.doubles.xrce_agent.messages import float64, read_diagnostics, read_float64
from tests.platforms.pico.xrce.agent import BoardAgent
from tests.platforms.pico.xrce.checks import ENDS, PUBLISHED
from tests.platforms.stm32.agent import agent_of
from tests.platforms.stm32.images import PLATFORMS
from tests.platforms.stm32.jiwy import AXES, RAD_PER_COUNT, Jiwy

HOMED = 900


@pytest.fixture(params=PLATFORMS)
def board(request: pytest.FixtureRequest) -> Iterator[tuple[Jiwy, BoardAgent]]:
    jiwy = Jiwy(request.param, "xrce")
    agent = agent_of(jiwy)
    yield jiwy, agent
    agent.close()


def point(agent: BoardAgent, setpoint: float) -> None:
    for axis in AXES:
        agent.topics.publish(f"rt/{axis}_subscriber", float64(setpoint), reliable=False)


def assert_undisturbed(jiwy: Jiwy, agent: BoardAgent) -> dict[str, str]:
    """Returns the values in the diagnostics of the next seconds."""
    agent.run(1100)
    values: dict[str, str] = read_diagnostics(agent.heard("rt/diagnostics")[-1].data).values
    assert values["fault"] == "none"
    assert {values[name] for name in ("missed", "overruns", "faults", "outputs_late")} == {"0"}
    assert jiwy.chip.interrupts(jiwy.timer.kind.update) == jiwy.ticks
    assert jiwy.chip.dma.errors == jiwy.chip.cache.hazards == jiwy.chip.resets == []
    return values


def test_it_is_a_node_of_an_agent_also_of_one_that_restarts(board: tuple[Jiwy, BoardAgent]) -> None:
    """Setpoints arrive within some cycles; each message has the value of the model's port in a cycle just before."""
    jiwy, agent = board
    agent.run(HOMED - jiwy.ticks)
    ends = {end.topic: (end.type, end.reliable) for end in [*agent.topics.readers, *agent.topics.writers]}
    assert ends.items() >= ENDS.items()
    for restarts in range(2):
        begin, first = agent.now(), jiwy.ticks
        for number in range(20):
            setpoint = 0.4 - 0.01 * number + 0.1 * restarts
            point(agent, setpoint)
            agent.run(5)
            assert {jiwy.rows[-1][f"inputs.setpoint_{axis}"] for axis in AXES} == {setpoint}
            agent.run(20)
        for axis in AXES:
            said = agent.heard(f"rt/{axis}_publisher", begin + PUBLISHED)
            assert len(said) == pytest.approx((jiwy.ticks - first) / 1000 / PUBLISHED, abs=2)
            assert max(late.time - soon.time for soon, late in itertools.pairwise(said)) < PUBLISHED + 0.004
            start = agent.now() - jiwy.ticks / 1000
            for each in said:
                cycle = round(1000 * (each.time - start))
                recent = [row[f"outputs.{axis}_logging"] for row in jiwy.rows[cycle - 5 : cycle]]
                assert read_float64(each.data) in recent
            assert len({each.data for each in said}) > 5
            assert jiwy.angle(axis) == pytest.approx(setpoint, abs=0.05 + RAD_PER_COUNT[axis])
        if restarts == 0:
            agent.kill()
            jiwy.run(700)
            agent.start()
            assert agent.run_until(lambda: len(agent.heard("rt/pan_publisher", agent.now() - 0.1)) > 1, 3000)
    values = assert_undisturbed(jiwy, agent)
    assert (values["reconnects"], values["malformed"], values["unsent"]) == ("1", "0", "0")


def test_noise_on_the_line_disturbs_nothing(board: tuple[Jiwy, BoardAgent]) -> None:
    """Frames are lost and damaged both ways, and garbage comes without pause; then the board is a node again."""
    jiwy, agent = board
    agent.run(HOMED - jiwy.ticks)
    chance, before = random.Random(7), len(jiwy.chip.levels)
    point(agent, 0.7)
    agent.run(3)
    for faults in (agent.to_board, agent.from_board):
        faults.loss = faults.corrupt = 0.2
    for _ in range(300):
        while len(jiwy.line.sent) < 200:
            jiwy.line.send(chance.randbytes(100))
        point(agent, chance.random())
        agent.run(1)
    jiwy.assert_levels_act_together(before, changes=50)
    agent.to_board.clear()
    agent.from_board.clear()
    jiwy.line.sent.clear()
    assert agent.run_until(lambda: len(agent.heard("rt/diagnostics", agent.now() - 0.5)) > 0, 5000)
    point(agent, 0.3)
    agent.run(20)
    assert {jiwy.rows[-1][f"inputs.setpoint_{axis}"] for axis in AXES} == {0.3}
    assert_undisturbed(jiwy, agent)
