# SPDX-License-Identifier: Apache-2.0
"""Faults of the board's communication while both axes hold a position: it reconnects, the control loop continues."""

from __future__ import annotations

import random

import pytest

from tests.platforms.pico.closed_loop.robot import AXES

from .board import AGENT_PORT, CONSOLE_PORT, Jiwy
from .checks import assert_undisturbed

PAN, TILT = AXES
SILENCE = 4000
"""Milliseconds after which a silent agent counts as lost."""
RECOVERY = 2000
"""Milliseconds after which streams that make no progress end the session."""
LATEST = 100
"""Milliseconds from the start of an agent to the board's first message, at most."""


def hold(jiwy: Jiwy, where: float = 0.2) -> None:
    """Both axes go to ``where``, set by a topic; from here on, counters count for the scenario."""
    jiwy.point(where, where)
    jiwy.agent.run(500)
    assert_holds(jiwy, where)
    jiwy.begin()


def assert_holds(jiwy: Jiwy, where: float = 0.2) -> None:
    """The axes are at ``where``, and the node's messages say so."""
    assert jiwy.angle("pan") == pytest.approx(where, abs=3 * PAN.rad_per_count)
    assert jiwy.angle("tilt") == pytest.approx(where, abs=3 * TILT.rad_per_count)


def assert_is_back(jiwy: Jiwy) -> None:
    """The loop was undisturbed; setpoints arrive, and published positions are those of the axes."""
    assert_holds(jiwy)
    assert_undisturbed(jiwy)
    hold(jiwy, 0.3)
    assert jiwy.position("pan") == pytest.approx(0.3, abs=3 * PAN.rad_per_count)
    assert jiwy.position("tilt") == pytest.approx(0.3, abs=3 * TILT.rad_per_count)


def restart(jiwy: Jiwy, times: int) -> list[float]:
    """Kills the agent and starts it again after 0 to 50 ms; milliseconds until the board's first message each time."""
    draw = random.Random(5)
    result = []
    for _ in range(times):
        jiwy.agent.kill()
        jiwy.agent.run(draw.uniform(0, 50))
        jiwy.agent.start()
        begin = jiwy.agent.now()
        result.append(1000 * (jiwy.agent.wait_for("rt/pan_publisher").time - begin))
        jiwy.agent.run(draw.uniform(0, 60))
    assert max(result) < LATEST
    assert jiwy.reconnects() == times
    return result


def freeze(jiwy: Jiwy) -> None:
    """The agent does not answer, but the port stays open: the board loses this agent, too, and finds it again."""
    begin = jiwy.agent.now()
    jiwy.agent.freeze()
    jiwy.agent.run(SILENCE + 500)
    assert_holds(jiwy)
    jiwy.agent.thaw()
    jiwy.agent.wait_for("rt/pan_publisher")
    jiwy.agent.run(200)
    assert [key for time, key in jiwy.agent.created if time > begin], "it has connected again"
    assert jiwy.reconnects() == 1


def garbage(jiwy: Jiwy) -> None:
    """Random bytes on both ports."""
    draw = random.Random(7)
    for _ in range(40):
        jiwy.pico.send(draw.randbytes(draw.randint(1, 400)), port=AGENT_PORT)
        jiwy.pico.send(draw.randbytes(draw.randint(1, 100)).replace(b"\n", b""), port=CONSOLE_PORT)
        jiwy.agent.run(draw.uniform(1, 15))
    recover(jiwy)


def flood(jiwy: Jiwy) -> None:
    """Invalid frames and commands on both ports, as fast as USB takes packets."""
    draw = random.Random(9)
    frames = "".join(chr(draw.randrange(32, 126)) for _ in range(997))
    jiwy.pico.call("usb_flood", text=frames + "~", port=AGENT_PORT)
    jiwy.pico.call("usb_flood", text="stats\nports\nwatch pan_publisher\nnonsense\n", port=CONSOLE_PORT)
    jiwy.agent.run(500)
    jiwy.pico.call("usb_flood", on=False, port=AGENT_PORT)
    jiwy.pico.call("usb_flood", on=False, port=CONSOLE_PORT)
    recover(jiwy)


def damage(jiwy: Jiwy) -> None:
    """Frames that are lost, cut, changed or reordered, in both directions."""
    for direction in (jiwy.agent.to_board, jiwy.agent.from_board):
        direction.loss, direction.corrupt, direction.truncate, direction.reorder = 0.1, 0.05, 0.05, 0.05
    jiwy.agent.run(1500)
    assert_holds(jiwy)
    for direction in (jiwy.agent.to_board, jiwy.agent.from_board):
        direction.clear()
    recover(jiwy)


def recover(jiwy: Jiwy) -> None:
    """Waits the time in which the board must recover by itself after any fault."""
    jiwy.pico.send("\nwatch none\n", port=CONSOLE_PORT)
    jiwy.agent.run(RECOVERY)
    jiwy.agent.wait_for("rt/pan_publisher")


def pull_the_cable(jiwy: Jiwy) -> None:
    """The board keeps its other supply, as on a robot."""
    for milliseconds in (30, 300, 1500):
        jiwy.pico.call("usb_detach")
        jiwy.agent.kill()
        jiwy.agent.run(milliseconds)
        assert_holds(jiwy)
        jiwy.pico.call("usb_attach")
        assert jiwy.agent.run_until(lambda: jiwy.pico.call("usb")["state"] == "configured", 500)
        jiwy.pico.call("usb_open", port=CONSOLE_PORT)
        jiwy.agent.start()
        jiwy.agent.wait_for("rt/pan_publisher")
    assert jiwy.reconnects() >= 3, "the console counts its readers too"


SCENARIOS = {"freeze": freeze, "garbage": garbage, "damage": damage, "cable": pull_the_cable, "flood": flood}
