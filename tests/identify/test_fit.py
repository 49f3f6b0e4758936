# SPDX-License-Identifier: Apache-2.0
"""The identified values are those of the physics that made the recording, and their errors are honest."""

from __future__ import annotations

import json
import math
import random
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator import bootstrap

from .robot import BOTH, JOG, Physics, Run, drive, plan

bootstrap.ensure("plot")
import numpy as np  # noqa: E402  # only after the check that it can be imported

from epg.identify.fit import Fit, fit  # noqa: E402
from epg.identify.samples import Samples, samples_of  # noqa: E402

PAN = Physics()
TILT = Physics(constant=0.00701, inertia=5.45e-8, viscous=4.18e-7, coulomb=7.01e-5, gear=1 / 76)
HEAVY = Physics(constant=0.05, resistance=2.0, inertia=4e-4, viscous=1e-4, coulomb=4e-3, gear=1 / 30)
SMOOTH = Physics(coulomb=0.0)
COARSE = math.pi / 2 / 221


def identify(run: Run) -> tuple[Samples, Fit]:
    samples = samples_of(np.array(run.time), np.array(run.position), np.array(run.duty))
    return samples, fit(samples)


def servo(setpoint: float, gain: float, limit: float) -> object:
    """The duty of a proportional controller whose setpoint steps at 0.1 s, and back at 0.6 s."""

    def duty(time: float, position: float) -> float:
        error = (setpoint if 0.1 <= time < 0.6 else 0.0) - position
        return max(-limit, min(limit, gain * error))

    return duty


@pytest.mark.parametrize(
    ("physics", "duty", "length", "options", "share"),
    [
        (PAN, JOG, 0.65, {}, 0.02),
        (PAN, BOTH, 1.2, {}, 0.01),
        (PAN, BOTH, 1.2, {"resolution": 0.0}, 0.005),
        (PAN, BOTH, 1.2, {"resolution": math.pi / 11120}, 0.005),
        (PAN, BOTH, 1.2, {"delay": 1}, 0.02),
        (PAN, BOTH, 1.2, {"delay": 2}, 0.02),
        (PAN, servo(1.0, 1.5, 0.9), 1.2, {}, 0.02),
        (TILT, BOTH, 1.2, {"resolution": COARSE}, 0.05),
        (TILT, servo(0.8, 2.0, 0.9), 1.2, {"resolution": COARSE}, 0.05),
        (HEAVY, plan((0.1, 0.0), (1.0, 0.2), (1.0, 0.0)), 2.1, {}, 0.02),
        (HEAVY, plan((0.1, 0.0), (1.0, 0.2), (1.0, 0.0)), 2.1, {"period": 0.01}, 0.05),
        (SMOOTH, BOTH, 1.2, {}, 0.01),
        (PAN, plan((0.3, 0.0), (0.2, -0.1), (0.3, 0.0)), 0.8, {"speed": 4.0}, 0.05),
    ],
)
def test_the_values_are_those_of_the_physics(
    physics: Physics, duty: object, length: float, options: dict[str, object], share: float
) -> None:
    run = drive(physics, duty, length, **options)  # type: ignore[arg-type]
    _, found = identify(run)
    largest = max(map(abs, run.duty))
    assert found.gain.value == pytest.approx(physics.gain, rel=share)
    assert found.time_constant.value == pytest.approx(physics.time_constant, rel=share)
    assert found.friction.value == pytest.approx(physics.friction, abs=share * largest)
    assert abs(found.delay.value - options.get("delay", 0) * options.get("period", 0.001)) < 0.0005  # type: ignore
    for value, true in (
        (found.gain, physics.gain),
        (found.time_constant, physics.time_constant),
        (found.friction, physics.friction),
    ):
        assert abs(value.value - true) <= 4.0 * value.error + 1e-3 * abs(true)  # and 0.1 % of the integration


def test_a_dead_zone_is_not_friction() -> None:
    """The run-out shows the difference: a motor with a dead zone runs out without friction."""
    wanted = plan((0.1, 0.0), (0.25, 0.15), (0.3, 0.0), (0.3, -0.1), (0.3, 0.0))

    def acting(time: float, position: float) -> float:
        duty = wanted(time, position)
        return math.copysign(max(abs(duty) - 0.021, 0.0), duty)

    run = drive(SMOOTH, acting, 1.25)
    run = Run(run.time, run.position, [wanted(time, 0.0) for time in run.time])
    samples = samples_of(np.array(run.time), np.array(run.position), np.array(run.duty))
    zone, friction = fit(samples, dead_zone=True), fit(samples)
    assert zone.friction.value == pytest.approx(0.021, abs=0.0005)
    assert zone.gain.value == pytest.approx(SMOOTH.gain, rel=0.01)
    assert zone.rms < 0.5 * samples.resolution
    assert friction.rms > 2.0 * zone.rms


def test_errors_are_honest() -> None:
    """Of 40 runs with noise and another phase of the encoder, 95 % have their true values within the printed errors."""
    chance = random.Random(1)
    outside = 0
    for _ in range(40):
        noise = [chance.gauss(0.0, 0.004) for _ in range(1200)]
        _, found = identify(drive(PAN, BOTH, 1.2, noise=noise, phase=chance.random()))
        outside += abs(found.gain.value - PAN.gain) > 2.0 * found.gain.error
        outside += abs(found.time_constant.value - PAN.time_constant) > 2.0 * found.time_constant.error
        outside += abs(found.friction.value - PAN.friction) > 2.0 * found.friction.error
    assert outside <= 12  # of 120


def test_a_run_into_an_end_stop_is_used_without_the_stop() -> None:
    run = drive(PAN, plan((0.1, 0.0), (0.4, 0.15), (0.1, 0.0), (0.3, -0.15), (0.3, 0.0)), 1.2, stop=1.2)
    samples, found = identify(run)
    assert samples.stop is not None
    arrival = next(time for time, position in zip(run.time, run.position) if position > 1.19)
    assert abs(samples.stop - arrival) < 0.01
    assert samples.time[0] > arrival  # the way back is the longer one
    assert found.gain.value == pytest.approx(PAN.gain, rel=0.02)
    assert found.time_constant.value == pytest.approx(PAN.time_constant, rel=0.03)


def test_a_reset_of_the_encoder_is_not_a_movement() -> None:
    run = drive(PAN, BOTH, 1.2)
    reset = next(row for row, time in enumerate(run.time) if time > 0.6)
    moved = Run(run.time, [p - (5.0 if row >= reset else 0.0) for row, p in enumerate(run.position)], run.duty)
    samples, found = identify(moved)
    assert samples.jump == pytest.approx(run.time[reset])
    assert found.gain.value == pytest.approx(PAN.gain, rel=0.03)


def test_rows_that_are_missing_do_no_harm() -> None:
    run = drive(PAN, BOTH, 1.2)
    missing = {*range(200, 230), *range(280, 330), 801}
    kept = [row for row in range(len(run.time)) if row not in missing]
    samples, found = identify(Run(*([column[row] for row in kept] for column in (run.time, run.position, run.duty))))
    assert samples.jump is None
    assert len(samples.time) > 900
    assert found.gain.value == pytest.approx(PAN.gain, rel=0.02)


def test_a_rest_changes_neither_values_nor_errors() -> None:
    short, long = identify(drive(PAN, BOTH, 1.2))[1], identify(drive(PAN, BOTH, 4.0))[1]
    assert long.gain.value == pytest.approx(short.gain.value, rel=0.002)
    assert long.gain.error == pytest.approx(short.gain.error, rel=0.3)


def test_signals_that_were_recorded_at_other_times(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A recording of topics has a line for each value; a duty holds until the next one."""
    run = drive(PAN, BOTH, 1.2)
    lines = ["time,topic,value"]
    before = None
    for time, position, duty in zip(run.time, run.position, run.duty, strict=True):
        if duty != before:
            lines.append(f"{time:.6f},drive,{duty}")
            before = duty
        lines.append(f"{time:.6f},angle,{position}")
    path = tmp_path / "topics.csv"
    path.write_text("\n".join([*lines, ""]), encoding="utf-8")
    command = ["identify", str(path), "--duty", "drive", "--position", "angle", "--output", str(tmp_path / "a.svg")]
    assert main([*command, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["values"]["gain"]["value"] == pytest.approx(PAN.gain, rel=0.01)
    assert found["rms"] < 0.5 * math.pi / 1112
    assert "measured" in (tmp_path / "a.svg").read_text(encoding="utf-8")
