# SPDX-License-Identifier: Apache-2.0
"""The ideal loop of JIWY against a plain integration of the equations in its docstring, with very small steps."""

from __future__ import annotations

import math

import pytest
from write_models import EXAMPLES

from epg.runs.reference import Reference, load_reference

H = 1e-5


@pytest.fixture(scope="module")
def reference() -> Reference:
    return load_reference(EXAMPLES / "jiwy" / "ideal_loop.py")


def profile(time: float) -> float:
    return 0.5 - 0.5 * math.cos(math.pi * time) if time < 1 else 1.0


def integrate(axis: str, seconds: float) -> list[float]:
    """The position at each millisecond; motor, gear and PID are separate blocks, integrated by semi-implicit Euler."""
    k, rotor, rotor_d, gear, camera, camera_d, kp, tau_i = {
        "pan": (0.018, 2.06e-7, 1.77e-6, 1 / 19, 3.0e-4, 2.0e-4, 2.6, 9.0),
        "tilt": (0.00701, 5.28e-8, 4.0e-7, 1 / 76, 4.5e-5, 1.0e-4, 1.6, 10.5),
    }[axis]
    tau_d, beta = 0.05, 0.17
    speed = angle = low_pass = integral = 0.0
    positions = []
    for step in range(round(seconds / H)):
        if step % 100 == 0:
            positions.append(angle)
        error = kp * (profile(step * H) - angle)
        derivative = (error - low_pass) / (beta * tau_d)  # of the filtered error
        low_pass += H * derivative
        lead = low_pass + tau_d * derivative
        integral += H * lead / tau_i
        torque = k * (12 * (lead + integral) - k * speed) / 12
        speed += H * (torque - (rotor_d + gear**2 * camera_d) * speed) / (rotor + gear**2 * camera)
        angle += H * gear * speed
    return positions


@pytest.mark.parametrize("axis", ["pan", "tilt"])
def test_reference_solves_the_equations(reference: Reference, axis: str) -> None:
    expected = integrate(axis, 1.5)
    time = [n / 1000 for n in range(len(expected))]
    found = reference(axis, time, [profile(t) for t in time])
    assert max(abs(a - b) for a, b in zip(found, expected)) < 5e-5
    assert max(found) > 0.9


def test_reference_stays_at_rest(reference: Reference) -> None:
    assert reference("pan", [], []) == []
    assert reference("tilt", [4.5, 4.501, 4.6], [0.7, 0.7, 0.7]) == pytest.approx([0.7] * 3, abs=1e-10)
