# SPDX-License-Identifier: Apache-2.0
"""The assignments of hardware to components: peripherals, pins, and the frequencies that dividers reach."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import Any

from epg.generator.emit.description import describe_divider
from epg.generator.quantity import show
from epg.generator.resolve.allocation import Assignment
from epg.generator.resolve.claims import TICK, ClaimKey


def divider_text(divider: Mapping[str, Any]) -> tuple[str, str]:
    """Frequency and remark as text for the user: ``("19.9984 kHz", "6250 steps; 20 kHz requested, -0.008 %")``."""
    reached, asked = Fraction(divider["reached"]), Fraction(divider["asked"])
    steps = f"{divider['steps']} steps"
    if divider["error"] == 0:
        return show(asked, "frequency"), steps
    return show(reached, "frequency"), f"{steps}; {show(asked, 'frequency')} requested, {100 * divider['error']:+.2g} %"


def hardware_data(assignments: Mapping[ClaimKey, Assignment]) -> list[dict[str, Any]]:
    """One entry for each claim, as data for programs."""
    return [
        {
            "component": component or None,
            "claim": claim,
            "resource": assignment.resource,
            "pins": dict(sorted(assignment.pin_names.items())),
            "divider": describe_divider(assignment),
            **({"start": assignment.start} if assignment.start else {}),
        }
        for (component, claim), assignment in assignments.items()
    ]


def hardware_rows(assignments: Mapping[ClaimKey, Assignment]) -> list[tuple[str, str, str, str, str]]:
    """One row of text for each claim, for the user: user of the hardware, hardware, pins, frequency, remark."""
    rows = []
    for key, entry in zip(assignments, hardware_data(assignments)):
        frequency, remark = divider_text(entry["divider"]) if entry["divider"] else ("", "")
        remark = "exactly" if key == TICK and remark else remark
        remark = "; ".join(filter(None, (remark, entry.get("start", ""))))
        pins = ", ".join(f"{signal} {pin}" for signal, pin in entry["pins"].items())
        user = "(control loop)" if key == TICK else f"{entry['component']}.{entry['claim']}"
        rows.append((user, entry["resource"], pins, frequency, remark))
    return rows
