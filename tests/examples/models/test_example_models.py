# SPDX-License-Identifier: Apache-2.0
"""The examples' models compute their equations, and the two JIWY models work in closed loop."""

from __future__ import annotations

import itertools
import math
from pathlib import Path

import pytest
from closed_loop import AXES, COUNTS_PER_RADIAN, Run, run
from write_models import EXAMPLES, model_files
from writer import equations

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model

JIWY = EXAMPLES / "jiwy"
START, LENGTH = 5.0, 3.0
RANGE = {"pan": math.pi, "tilt": math.pi / 2}


@pytest.fixture(scope="module")
def build(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("exports")


def profile(_axis: str, time: float) -> float:
    """The raised cosine of 1 rad: forwards and back in 3 s."""
    phase = (time - START) / LENGTH
    return 0.5 - 0.5 * math.cos(2 * math.pi * phase) if 0 < phase < 1 else 0.0


def rms(recorded: Run, axis: str) -> float:
    errors = [
        angle - setpoint
        for time, angle, setpoint in zip(recorded.time, recorded.angle[axis], recorded.setpoint[axis])
        if START <= time <= START + LENGTH
    ]
    return math.sqrt(sum(error * error for error in errors) / len(errors))


def test_files_are_what_the_equations_say() -> None:
    for path, text in model_files().items():
        assert (EXAMPLES / path).read_text(encoding="utf-8") == text, f"{path}: run write_models.py"


@pytest.mark.parametrize(
    "folder", ["jiwy/model", "jiwy/plant", "relbot/model", "relbot/plant", "existing_firmware/station/model"]
)
def test_importer_reads_them(folder: str) -> None:
    """Ports, parameters and metadata are consistent: there is no warning."""
    diagnostics = Diagnostics()
    model = load_model(EXAMPLES / folder, diagnostics)
    assert model is not None
    assert [item.message for item in diagnostics] == []
    assert (model.inputs, model.outputs) != ((), ())


def test_equation_language() -> None:
    names = {"a": "A", "b\\c": "B"}
    assert equations.to_c("a * -b\\c + 2", names.__getitem__) == "A * -B + 2.0"
    assert equations.to_c("not a or b\\c <> 1", names.__getitem__) == "(!A || (B != 1.0))"
    assert equations.names("if a > 0 then b\\c else abs (d) end") == {"a", "b\\c", "d"}
    with pytest.raises(ValueError, match="'end' expected"):
        equations.parse("if a then 1 else 2")


def test_tracks_a_raised_cosine(build: Path) -> None:
    recorded = run(JIWY, build, START + LENGTH, profile)
    assert rms(recorded, "pan") <= 0.03
    assert rms(recorded, "tilt") <= 0.05
    for axis in AXES:
        assert max(abs(duty) for duty in recorded.duty[axis]) < 0.5


@pytest.mark.parametrize("place", [0.0, 0.02, 0.1, 0.5, 0.98, 1.0])
def test_homes_from_anywhere(build: Path, place: float) -> None:
    starts = {f"{axis.capitalize()}\\start": place * RANGE[axis] for axis in AXES}
    recorded = run(JIWY, build, START, profile, plant=starts)
    for axis in AXES:
        assert abs(recorded.angle[axis][-1]) < 1.5 / COUNTS_PER_RADIAN[axis]
        assert sum(recorded.reset[axis]) == pytest.approx(6), "one pulse of the reset"
        assert max(abs(duty) for duty in recorded.duty[axis]) < 0.061


def test_hand_over_has_no_kick(build: Path) -> None:
    """If the setpoint is far away when control begins, the axis moves there at the reference's speed."""
    recorded = run(JIWY, build, START, lambda axis, time: 1.0)
    for axis in AXES:
        pulse = recorded.reset[axis].index(1.0)
        after = recorded.duty[axis][pulse:]
        assert abs(recorded.angle[axis][-1] - 1.0) < 0.03
        assert max(abs(duty) for duty in after) < 0.35
        assert max(abs(b - a) for a, b in itertools.pairwise(after)) < 0.12, "a count of the encoder is worth 0.07"
        speeds = [(b - a) / 0.001 for a, b in itertools.pairwise(recorded.angle[axis])]
        assert max(speeds) < 1.7


def _gave_up(recorded: Run, axis: str, since: float) -> bool:
    return all(duty == 0.0 for time, duty in zip(recorded.time, recorded.duty[axis]) if time > since)


def test_homing_gives_up(build: Path) -> None:
    """Without motion, without an encoder, without a reset and in the wrong direction, the duty ends at zero."""
    dead = run(JIWY, build, 8.0, profile, plant={"Pan\\Motor\\k": 0.0})
    assert _gave_up(dead, "pan", 6.01)
    assert not _gave_up(dead, "pan", 5.9), "until the time limit"
    assert not _gave_up(dead, "tilt", 6.01), "the other axis works on"

    blind = run(JIWY, build, 8.0, profile, encoder_works=False)
    stuck = run(JIWY, build, 8.0, profile, reset_works=False)
    wrong = run(JIWY, build, 3.0, profile, plant={f"{axis.capitalize()}\\Motor\\k": -0.01 for axis in AXES})
    for axis in AXES:
        assert _gave_up(blind, axis, 6.01)
        assert _gave_up(stuck, axis, 6.01)
        assert _gave_up(wrong, axis, 1.0)


def test_end_stops_hold(build: Path) -> None:
    """A setpoint beyond the range presses the axis against its stop; the axis returns as soon as the setpoint does."""
    recorded = run(JIWY, build, 9.0, lambda axis, time: 9.0 if 4.0 < time < 6.0 else 0.5)
    for axis in AXES:
        assert RANGE[axis] < max(recorded.angle[axis]) < RANGE[axis] + 0.05
        assert abs(recorded.angle[axis][-1] - 0.5) < 0.05
        assert all(abs(duty) <= 0.9901 for duty in recorded.duty[axis])
