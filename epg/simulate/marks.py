# SPDX-License-Identifier: Apache-2.0
"""The times of a run at which its target was enabled, was disabled, or had a fault, as marks for plots.

>>> times = [0.0, 0.001, 0.002, 0.003]
>>> enabled, fault = Signal(times, [1.0, 1.0, 0.0, 1.0]), Signal(times, [0.0, 0.0, 6.0, 0.0])
>>> [(mark.time, mark.text) for mark in state_marks({"enabled": enabled, "fault": fault})]
[(0.0, 'enabled'), (0.002, 'fault: stall'), (0.003, 'enabled')]
"""

from __future__ import annotations

from collections.abc import Mapping

from epg.runs.plot_style import BLACK, GREEN, ORANGE, Mark
from epg.runs.recording import Signal

FAULTS = {
    1: "not finite",
    2: "model stopped",
    3: "overrun",
    4: "setpoint timeout",
    5: "fail-safe",
    6: "stall",
    7: "runaway",
    8: "homing travel",
    9: "homing time",
    10: "sensor",
    11: "watchdog",
    12: "processor",
    13: "output",
    14: "tick",
    15: "priority",
    16: "operator",
}
"""The names of the faults in traces: those of ``epg/fault.h`` and of EPG's component kinds."""

SIGNALS = ("enabled", "fault")
"""The signals of a trace from which marks are made."""

MOST = 12
"""The greatest number of marks of one target: a plot with more of them is not readable."""


def state_marks(signals: Mapping[str, Signal], target: str = "") -> list[Mark]:
    """The marks of one target, which is written in front of the text if it is one of a system.

    A target that is disabled at the start has no mark there.  A recording without :data:`SIGNALS` has no marks.
    """
    name, prefix = (f"{target}: ", f"{target}/") if target else ("", "")
    if not all(prefix + signal in signals for signal in SIGNALS):
        return []
    first, second = (signals[prefix + signal] for signal in SIGNALS)
    times = first.time if first.time is second.time else sorted({*first.time, *second.time})
    marks: list[Mark] = []
    enabled, fault = 0.0, 0.0
    for time, now, code in zip(times, first.at(times), second.at(times)):
        if now == enabled and code == fault:
            continue
        if code not in (0.0, fault):
            marks.append(Mark(time, f"{name}fault: {FAULTS.get(int(code), str(int(code)))}", ORANGE))
        elif now != enabled:
            marks.append(Mark(time, f"{name}enabled", GREEN) if now else Mark(time, f"{name}disabled", BLACK))
        enabled, fault = now, code
    return marks[:MOST]
