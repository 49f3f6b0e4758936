# SPDX-License-Identifier: Apache-2.0
"""The turntable of ``examples/existing_firmware``: a PI controller of its angle with a limited duty cycle."""

from __future__ import annotations

from writer.model import Definition, define

_CONTROL = r"""
inputs
    position {rad}
    setpoint {rad}
outputs
    duty
    error_logging {rad}
parameters
    PI\kp = 1.8 {1/rad}
    PI\tauI = 2.5 {s}
    Limiter\maximum = 0.9 {}
states
    PI\integral_previous : PI\integral
static
    PI\factor = sampletime / PI\tauI
dynamic
    PI\error = setpoint - position
    PI\proportional = PI\kp * PI\error
    PI\sum = PI\integral_previous + PI\proportional
    PI\windup = PI\sum > Limiter\maximum and PI\error > 0 or PI\sum < -Limiter\maximum and PI\error < 0
    PI\integral = if PI\windup then PI\integral_previous else PI\integral_previous + PI\factor * PI\proportional end
    Limiter\output = if PI\sum > Limiter\maximum then Limiter\maximum
        else (if PI\sum < -Limiter\maximum then -Limiter\maximum else PI\sum end) end
output
    duty = Limiter\output
    error_logging = PI\error
"""


def control() -> Definition:
    return define("Turntable_Control", "Discrete", "0.001", "20.0", _CONTROL)
