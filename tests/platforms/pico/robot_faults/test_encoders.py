# SPDX-License-Identifier: Apache-2.0
"""Encoders with swapped or broken wires: JIWY's images stop the motors, as docs/runtime.md and the .tcf promise."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest

from tests.platforms.pico.closed_loop.board import Board, image
from tests.platforms.pico.closed_loop.robot import AXES, PERIOD
from tests.platforms.pico.images import PLATFORMS, skip_unless_emulated

PAN, TILT = AXES
NEAR = {"pan": 0.12, "tilt": 0.12}
MODEL_WRONG = 0.25
"""Angle in the wrong direction, in rad, at which the model's own homing stops: examples/jiwy/README.md."""
RUNAWAY = math.radians(20)
STALL_TIME = 0.5
"""Seconds, for both motion guards in targets/robots/jiwy/jiwy.tcf."""
COASTING = 0.1
"""Largest angle in rad that pan still moves after homing's duty of 0.05: 1.3 rad/s, time constant 57 ms."""


@pytest.fixture(params=PLATFORMS)
def platform(request: pytest.FixtureRequest) -> Iterator[str]:
    skip_unless_emulated(request.param)
    yield request.param


def test_swapped_wires_are_noticed_by_homing(platform: str) -> None:
    """The model drives down but the counts go up: the model stops that axis, and the other axis homes."""
    with Board(image(platform), {"pan": 1.0, "tilt": 0.12}, swapped=["pan"]) as board:
        board.run_until_safe(PAN, milliseconds=600)
        assert 1.0 - MODEL_WRONG - COASTING < board.motor("pan")["angle"] < 1.0 - MODEL_WRONG + 2 * PAN.rad_per_count
        board.assert_stays_safe(PAN, milliseconds=700)
        assert board.stats()["enabled"] == "1"
        assert abs(board.motor("tilt")["angle"]) < TILT.rad_per_count


def test_swapped_wires_are_a_runaway_to_the_guard(platform: str) -> None:
    """Without the model's own check, the guard detects it and makes both axes safe."""
    with Board(image(platform), {"pan": 1.0, "tilt": 1.0}, swapped=["pan"]) as board:
        board.ask(r"set Pan\Homing\wrong=10")
        board.run_until_safe(*AXES, milliseconds=800)
        assert 1.0 - RUNAWAY - COASTING < board.motor("pan")["angle"] < 1.0 - RUNAWAY + 2 * PAN.rad_per_count
        stats = board.stats()
        assert (stats["enabled"], stats["fault"], stats["component"]) == ("0", "runaway", "guard_pan")
        board.assert_stays_safe(*AXES, milliseconds=50)


def test_an_encoder_that_dies_while_the_axis_moves_is_a_stall(platform: str) -> None:
    with Board(image(platform), NEAR) as board:
        board.home()
        board.ask("pan_subscriber=1 tilt_subscriber=0.5")
        board.pico.run(milliseconds=20)
        board.pico.call("encoder_dead", name="pan")
        died = board.pico.cycle
        safe = board.run_until_safe(*AXES, milliseconds=700)
        assert 0.3 < (safe - died) / (1000 * PERIOD) < STALL_TIME + 0.05
        stats = board.stats()
        assert (stats["enabled"], stats["fault"], stats["component"]) == ("0", "stall", "guard_pan")
        board.assert_stays_safe(*AXES, milliseconds=50)


def test_an_encoder_that_is_dead_from_the_start_ends_homing(platform: str) -> None:
    """The axis seems to stand still: the model tries the other direction until its time limit."""
    with Board(image(platform), {"pan": 1.0, "tilt": 0.12}) as board:
        board.pico.call("encoder_dead", name="pan")
        board.ask(r"set Pan\Homing\limit=0.5")
        board.run_until_safe(PAN, milliseconds=700)
        board.assert_stays_safe(PAN, milliseconds=200)
        assert board.stats()["enabled"] == "1"
