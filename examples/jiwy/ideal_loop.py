# SPDX-License-Identifier: Apache-2.0
"""The ideal loop of JIWY: what each axis would do under a controller and sensors without limits.

Continuous time, no encoder counts, no PWM steps, no delay, no Coulomb friction, no end stops.  It shares no code and
no file with the models beside it, so that a plot of both does not compare the simulation with itself.

Plant, reflected to the rotor (Laplace transforms; duty u, angle y of the camera)::

    J w' = k i - d w        i = (U u - k w) / R        y' = n w

Controller, a PID in series form with a filtered derivative (error e)::

    u = kp (1 + tauD s) / (1 + beta tauD s) (1 + 1 / (tauI s)) e

The loop is linear with constant coefficients.  It is solved with the matrix exponential, exact for a setpoint that is
a straight line between two samples: C. F. Van Loan, "Computing integrals involving the matrix exponential", IEEE
Transactions on Automatic Control 23(3), 1978.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

Matrix = list[list[float]]


@dataclass(frozen=True)
class Axis:
    """SI units.  Motor data, gear and camera as published for the robot; R keeps the stall torque at 12 V."""

    k: float  # motor constant, N m/A
    rotor_inertia: float  # kg m2
    rotor_friction: float  # N m s/rad
    ratio: float  # camera angle per rotor angle
    camera_inertia: float
    camera_friction: float
    kp: float
    tau_i: float  # s
    tau_d: float = 0.05  # s
    beta: float = 0.17
    voltage: float = 12.0  # V
    resistance: float = 12.0  # ohm


AXES = {
    "pan": Axis(0.018, 2.06e-7, 1.77e-6, 1 / 19, 3.0e-4, 2.0e-4, kp=2.6, tau_i=9.0),
    "tilt": Axis(0.00701, 5.28e-8, 4.0e-7, 0.25 / 19, 4.5e-5, 1.0e-4, kp=1.6, tau_i=10.5),
}


def reference(axis: str, time: Sequence[float], setpoint: Sequence[float]) -> list[float]:
    """Camera angle in rad at each time (s), for a setpoint in rad; at rest at the first setpoint before."""
    if not time:
        return []
    a, b = _closed_loop(AXES[axis])
    x = [0.0, setpoint[0], 0.0, 0.0]  # no error, so no filter state
    positions = [x[1]]
    solutions: dict[float, tuple[Matrix, list[float], list[float]]] = {}
    for n in range(1, len(time)):
        step = round(time[n] - time[n - 1], 12)
        if step not in solutions:
            solutions[step] = _solve(a, b, step)
        phi, gain, slope_gain = solutions[step]
        slope = (setpoint[n] - setpoint[n - 1]) / step if step > 0.0 else 0.0
        x = [
            sum(phi[i][j] * x[j] for j in range(4)) + gain[i] * setpoint[n - 1] + slope_gain[i] * slope
            for i in range(4)
        ]
        positions.append(x[1])
    return positions


def _closed_loop(axis: Axis) -> tuple[Matrix, list[float]]:
    """x' = A x + B r, with x = (rotor speed, camera angle, state of the derivative filter, integral)."""
    n = axis.ratio
    inertia = axis.rotor_inertia + n * n * axis.camera_inertia
    friction = axis.rotor_friction + n * n * axis.camera_friction
    damping = (friction + axis.k * axis.k / axis.resistance) / inertia
    drive = axis.k * axis.voltage / axis.resistance / inertia
    # lead = gain * (r - y) + filter state; filter state' = (kp (r - y) - lead) / (beta tauD); integral' = lead / tauI
    gain = axis.kp / axis.beta
    corner = 1 / (axis.beta * axis.tau_d)
    a = [
        [-damping, -drive * gain, drive, drive],
        [n, 0.0, 0.0, 0.0],
        [0.0, -corner * (axis.kp - gain), -corner, 0.0],
        [0.0, -gain / axis.tau_i, 1 / axis.tau_i, 0.0],
    ]
    b = [drive * gain, 0.0, corner * (axis.kp - gain), gain / axis.tau_i]
    return a, b


def _solve(a: Matrix, b: list[float], step: float) -> tuple[Matrix, list[float], list[float]]:
    """Transition over one step: of the state, of a constant setpoint, and of the setpoint's slope."""
    size = len(a)
    block = [[*row, entry, 0.0] for row, entry in zip(a, b)]
    block += [[0.0] * size + [0.0, 1.0], [0.0] * (size + 2)]
    whole = _exponential([[value * step for value in row] for row in block])
    phi = [row[:size] for row in whole[:size]]
    return phi, [row[size] for row in whole[:size]], [row[size + 1] for row in whole[:size]]


def _exponential(m: Matrix) -> Matrix:
    """exp(m) by scaling and squaring: the series is summed for m / 2^s, whose norm is below 1/8."""
    size = len(m)
    norm = max(sum(map(abs, row)) for row in m)
    squarings = 0
    while norm > 0.125:
        norm /= 2
        squarings += 1
    small = [[value / 2**squarings for value in row] for row in m]
    result = [[float(i == j) for j in range(size)] for i in range(size)]
    term = [row[:] for row in result]
    for order in range(1, 16):  # 0.125^16 / 16! is far below double precision
        term = [[value / order for value in row] for row in _product(term, small)]
        result = [[p + q for p, q in zip(r, t)] for r, t in zip(result, term)]
    for _ in range(squarings):
        result = _product(result, result)
    return result


def _product(p: Matrix, q: Matrix) -> Matrix:
    columns = list(zip(*q))
    return [[sum(x * y for x, y in zip(row, column)) for column in columns] for row in p]
