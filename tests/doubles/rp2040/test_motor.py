# SPDX-License-Identifier: Apache-2.0
"""The motor behind the bridge against a small-step integration of the same equations, and its end stops."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import pytest

from .conftest import Board

PAN = {
    "constant": 0.018, "resistance": 12, "supply": 12, "inertia": 2.06e-7 + 3.0e-4 / 361,
    "friction": 1.77e-6 + 2.0e-4 / 361, "gear": 1 / 19, "countsPerRadian": 1112 / math.pi,
}  # fmt: skip
BRIDGE = {"slice": 1, "channel": 0, "pinA": 14, "pinB": 15}


@dataclass
class Reference:
    """Semi-implicit integration with steps of one microsecond."""

    angle: float = 0.0
    speed: float = 0.0

    def run(self, duration: float, duty: float, *, coast: bool = False) -> None:
        step = 1e-6
        dry = 0.01 * PAN["constant"] * PAN["supply"] / PAN["resistance"]
        for _ in range(round(duration / step)):
            current = 0.0 if coast else (PAN["supply"] * duty - PAN["constant"] * self.speed) / PAN["resistance"]
            torque = PAN["constant"] * current - PAN["friction"] * self.speed
            if self.speed == 0.0:
                torque = 0.0 if abs(torque) <= dry else torque - math.copysign(dry, torque)
            else:
                torque -= math.copysign(dry, self.speed)
            new = self.speed + step * torque / PAN["inertia"]
            if self.speed != 0.0 and new * self.speed < 0:
                new = 0.0
            self.angle += step * 0.5 * (new + self.speed) * PAN["gear"]
            self.speed = new


def drive(board: Board, duty: float) -> None:
    """Sets the duty cycle on slice 1 and its sign on the direction pins, as the firmware does."""
    board.case("case_pwm", 6249, round(abs(duty) * 6250), 0, 16, 0)
    board.case("case_pins", 14, 1, int(duty > 0), 0)
    board.case("case_pins", 15, 1, int(duty < 0), 0)


def motor(board: Board, **parameters: object) -> None:
    board.pico.call("encoder", name="pan", a=10, b=11)
    board.pico.call("motor", name="pan", encoder="pan", bridge=BRIDGE, axis="pan", **parameters)


def state(board: Board) -> dict[str, float]:
    result: dict[str, float] = board.pico.call("motor_state", name="pan")
    return result


def test_acceleration_and_coasting(board: Board) -> None:
    drive(board, 0.0)
    motor(board)
    reference = Reference()
    begin = board.pico.cycle
    drive(board, 0.5)
    delay = (board.pico.cycle - begin) / 125e6
    board.pico.run(milliseconds=30)
    reference.run(0.03 + delay, 0.5)
    assert state(board)["speed"] == pytest.approx(reference.speed, rel=0.05)  # the case itself takes a while
    reference = Reference(state(board)["angle"], state(board)["speed"])
    board.pico.run(milliseconds=20)
    reference.run(0.02, 0.5)
    assert state(board)["speed"] == pytest.approx(reference.speed, rel=2e-4)
    assert state(board)["angle"] == pytest.approx(reference.angle, rel=2e-4)
    board.pico.call("write_register", address=0xD0000018, value=3 << 14)  # both direction pins low
    assert state(board)["mode"] == "coast"
    reference = Reference(state(board)["angle"], state(board)["speed"])
    board.pico.run(milliseconds=20)
    reference.run(0.02, 0.0, coast=True)
    assert state(board)["speed"] == pytest.approx(reference.speed, rel=2e-4)
    assert state(board)["angle"] == pytest.approx(reference.angle, rel=2e-4)


def test_braking_to_rest(board: Board) -> None:
    drive(board, -0.8)
    motor(board)
    board.pico.run(milliseconds=50)
    assert state(board)["speed"] < -50
    board.pico.call("write_register", address=0xD0000014, value=3 << 14)  # both high
    assert state(board)["mode"] == "brake"
    reference = Reference(state(board)["angle"], state(board)["speed"])
    board.pico.run(milliseconds=250)
    reference.run(0.25, 0.0)
    assert state(board)["speed"] == reference.speed == 0.0
    assert state(board)["angle"] == pytest.approx(reference.angle, rel=1e-3)


def test_friction_holds_a_small_duty(board: Board) -> None:
    motor(board)
    drive(board, 0.009)
    board.pico.run(milliseconds=20)
    assert (state(board)["speed"], state(board)["angle"]) == (0.0, 0.0)
    drive(board, 0.02)
    board.pico.run(milliseconds=20)
    assert state(board)["speed"] > 0


def test_end_stops_and_the_encoder(board: Board) -> None:
    """The encoder's edges follow the angle, and stop when the motor reaches an end stop."""
    motor(board, stops=[-0.5, 0.3])
    for duty, angle in ((0.7, 0.3), (-0.7, -0.5), (0.7, 0.3)):
        drive(board, duty)
        board.pico.run(milliseconds=400)
        after = state(board)
        assert (after["angle"], after["speed"]) == (angle, 0.0)
        count = math.floor(angle * PAN["countsPerRadian"])
        assert abs(board.pico.call("encoder_count", name="pan") - count) <= 1


def test_edges_come_when_the_shaft_passes_them(board: Board) -> None:
    motor(board)
    board.pico.call("watch_pins", pins=[10, 11])
    drive(board, 1.0)
    board.pico.run(milliseconds=300)
    before = state(board)
    edges = board.pico.call("take", log="pins")
    board.pico.run(milliseconds=20)
    edges = board.pico.call("take", log="pins")
    after = state(board)
    speed = (before["speed"] + after["speed"]) / 2 * PAN["gear"] * PAN["countsPerRadian"]  # counts/s, almost constant
    assert len(edges) == pytest.approx(speed * 0.02, abs=1.5)
    gaps = [(later[0] - earlier[0]) / 125e6 for earlier, later in itertools.pairwise(edges)]
    assert all(gap == pytest.approx(1 / speed, rel=0.02) for gap in gaps)
