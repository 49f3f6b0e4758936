# SPDX-License-Identifier: Apache-2.0
"""The promises that an image must keep when it has run a scenario."""

from __future__ import annotations

import re

from .comparison import CONTROL, Comparison
from .robot import AXES

RMS_COUNTS, LARGEST_COUNTS = 2.0, 4.0
"""Tolerance between the image's axis and the host's, in counts of its encoder (2.8 mrad for pan, 7.1 mrad for tilt).

The two differ in physics: setpoints arrive 1 to 2 ms later over USB; outputs act 0.25 ms after the tick instead of at
the tick; on the host, end stops are springs and dry friction is viscous below 0.2 rad/s.
"""

LATEST = 5
"""Cycles within which a setpoint arrives: two packets of up to 1.1 ms each, the console's poll, the next tick."""


def assert_all_is_well(compared: Comparison, *, latest: int = LATEST, largest: float = LARGEST_COUNTS) -> None:
    """``latest`` is in cycles, ``largest`` in counts.  They differ if a console needs longer to read a command than on
    a Pico with its own core for communication."""
    assert_follows(compared)
    assert_near_the_host(compared, largest)
    assert_bits_of_the_host(compared)
    assert_setpoints_unchanged(compared, latest)
    assert_statistics(compared)


def assert_follows(compared: Comparison) -> None:
    """Homing and motion keep the scenario's limits, in the image as on the host."""
    for columns in (compared.image.columns, compared.simulated):
        checks = compared.checks(columns)
        assert len(checks) >= 8
        assert [held for held in checks if not held.passed] == []
    for axis in AXES:
        resets = compared.image.columns[f"outputs.encoder_reset_{axis.name}"]
        assert max(resets) == 1.0, "homing has ended with a reset of the encoder"


def assert_near_the_host(compared: Comparison, largest: float = LARGEST_COUNTS) -> None:
    for axis in AXES:
        rms, farthest = compared.difference(axis.name)
        assert rms <= RMS_COUNTS * axis.rad_per_count
        assert farthest <= largest * axis.rad_per_count


def assert_bits_of_the_host(compared: Comparison) -> None:
    """With the same counts and setpoints, the host computes the same bits in every cycle, including the PWM's duty."""
    duties = [f"plant.inputs.duty_{axis.name}" for axis in AXES]
    for name in (*CONTROL, *duties):
        image, host = compared.image.columns[name], compared.replayed[name]
        assert len(image) == len(host)
        assert [n for n, pair in enumerate(zip(image, host)) if pair[0] != pair[1]] == [], name
    for name in duties:
        assert len(set(compared.image.columns[name])) > 100, "there was something to compare"


def assert_setpoints_unchanged(compared: Comparison, latest: int = LATEST) -> None:
    """Every setpoint that was sent has reached the model bit by bit and in time; no other setpoint has."""
    image = compared.image
    interval = round(float(compared.scenario.interval) * 1000)
    for axis in AXES:
        column = image.columns[f"inputs.setpoint_{axis.name}"]
        sent = [values[f"{axis.name}_subscriber"] for values in image.sent]
        for number, value in enumerate(column):
            newest = number // interval
            allowed = {sent[newest]}
            if number % interval < latest:
                allowed.add(sent[newest - 1] if newest > 0 else 0.0)
            assert value in allowed, (axis.name, number)


def assert_statistics(compared: Comparison) -> None:
    found = {name: int(value) for name, value in re.findall(r"^stat (\w+)=(\d+)\r?$", compared.image.said, re.M)}
    assert found["cycles"] >= compared.image.cycles
    for name in ("overruns", "missed", "faults", "clamped", "setpoints_dropped", "lines_dropped"):
        assert found[name] == 0, name
