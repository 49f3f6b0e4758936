# SPDX-License-Identifier: Apache-2.0
"""Refuses recordings that do not determine a motor, each with its reason and the remedy."""

from __future__ import annotations

from typing import TYPE_CHECKING

from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span
from epg.identify.samples import FEWEST_ROWS, Samples

if TYPE_CHECKING:
    from epg.identify.fit import Fit, FittedValue

FEWEST_COUNTS = 20
MOST_ERROR = 0.1
"""The largest error of a value, for a confidence of 95 %: of gain and time constant as a share of the value, of the
friction as a share of the largest duty."""
MOST_RMS, ROUGH_RMS = 0.05, 0.003
"""RMS of measured - simulated, as a share of the movement: refused above, and a warning."""
MORE = "record the rest before the movement, a longer jog in both directions, and the run-out: see docs/identify.md"


def judge_samples(samples: Samples, position: str, duty: str, file: str, diagnostics: Diagnostics) -> None:
    """Reports why the samples cannot be used, before a fit."""
    span = Span(file)
    if samples.stop is not None:
        message = f"the motor reaches an end stop at {samples.stop:.3f} s: {_part(samples)}"
        hint = "--from and --until choose another part"
        diagnostics.warning("identify-end-stop", span, message, hint=hint)
    if samples.jump is not None:
        message = f"'{position}' jumps at {samples.jump:.3f} s, as after a reset: {_part(samples)}"
        hint = "--from and --until choose another part"
        diagnostics.warning("identify-jump", span, message, hint=hint)
    if len(samples.time) < FEWEST_ROWS:
        message = f"there are {len(samples.time)} rows of one movement, and at least {FEWEST_ROWS} are needed"
        diagnostics.error("identify-few-rows", span, message, hint="record for a longer time, in every control cycle")
    elif len(samples.duties) < 2 and samples.duties[0] == 0.0:
        message = f"the duty '{duty}' is 0 in all rows: nothing drives the motor"
        hint = "record while the motor is moved; during jog, only 'actuators.<name>' has the duty"
        diagnostics.error("identify-no-duty", span, message, hint=hint)
    elif samples.moved == 0.0:
        message = f"the motor does not move: '{position}' has one value in all rows"
        hint = "drive it with a larger duty; see that both signals belong to one motor"
        diagnostics.error("identify-still", span, message, hint=hint)
    elif samples.counted and samples.counts < FEWEST_COUNTS:
        message = f"the motor moves by {samples.counts:.0f} counts, and at least {FEWEST_COUNTS} are needed"
        hint = "drive it longer, or with a larger duty"
        diagnostics.error("identify-few-counts", span, message, hint=hint)
    elif len(samples.duties) < 2:
        message = f"the duty '{duty}' is {samples.duties[0]:g} in all rows: friction and gain cannot be separated"
        hint = "begin the recording before the movement, and end it after the run-out"
        diagnostics.error("identify-one-duty", span, message, hint=hint)


def _part(samples: Samples) -> str:
    if not len(samples.time):
        return "no movement is left"
    return f"only the movement from {float(samples.time[0]):.3f} s to {float(samples.time[-1]):.3f} s is used"


def judge_fit(fit: Fit, samples: Samples, file: str, diagnostics: Diagnostics) -> None:
    """Reports why the identified values are of no use."""
    span = Span(file)
    length = float(samples.time[-1] - samples.time[0])
    largest = max(abs(duty) for duty in samples.duties)
    tau = fit.time_constant.value
    if fit.rms > MOST_RMS * samples.moved:
        message = f"no motor of first order moves like this: {_rms(fit, samples)}"
        hint = "see the picture; are both signals of one motor, does it hit a stop, does gravity pull it?"
        diagnostics.error("identify-misfit", span, message, hint=hint)
    elif tau < samples.period:
        message = f"the time constant is shorter than the {1e3 * samples.period:g} ms between two rows"
        diagnostics.error("identify-too-fast", span, message, hint="record every control cycle: --every 1")
    elif tau > length:
        message = f"the time constant is longer than the movement of {length:.3g} s: the speed only rises"
        diagnostics.error("identify-too-short", span, message, hint="move the motor for a longer time")
    elif fit.gain.value < 0.0:
        message = "a positive duty decreases the position"
        hint = "set 'invert' of the encoder or of the actuator: see docs/bring-up.md"
        diagnostics.error("identify-backwards", span, message, hint=hint)
    else:
        errors = {
            "gain": relative(fit.gain),
            "time constant": relative(fit.time_constant),
            "friction": 2.0 * fit.friction.error / largest,
        }
        # Beyond 100 % the errors depend on the rounding of numpy. Then, the first of these values counts as the worst.
        worst = max(errors, key=lambda name: min(errors[name], 1.0))
        if errors[worst] > MOST_ERROR:
            of = "of the largest duty" if worst == "friction" else "of its value"
            by = f"{100.0 * errors[worst]:.0f} %" if errors[worst] < 1.0 else "more than 100 %"
            message = f"the {worst} is uncertain by {by} {of}, and at most {100.0 * MOST_ERROR:.0f} % is accepted"
            diagnostics.error("identify-uncertain", span, message, hint=MORE)
        elif fit.rms > max(ROUGH_RMS * samples.moved, 1.5 * samples.resolution):
            message = f"the motor is not quite one of first order: {_rms(fit, samples)}"
            hint = (
                "see the picture; has the motor a dead zone (--dead-zone), a belt, a bridge that coasts at a duty of 0?"
            )
            diagnostics.warning("identify-rough", span, message, hint=hint)


def _rms(fit: Fit, samples: Samples) -> str:
    return f"the RMS of measured - simulated is {100.0 * fit.rms / samples.moved:.1f} % of the way"


def relative(value: FittedValue) -> float:
    """The error of a value for a confidence of 95 %, as a share of the value."""
    return 2.0 * value.error / abs(value.value) if value.value else float("inf")
