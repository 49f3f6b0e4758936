# SPDX-License-Identifier: Apache-2.0
"""The times of a run at which its target was enabled, was disabled, or had a fault, as marks for plots.

>>> columns = {"time": [0.0, 0.001, 0.002, 0.003], "enabled": [1.0, 1.0, 0.0, 1.0], "fault": [0.0, 0.0, 6.0, 0.0]}
>>> [(mark.time, mark.text) for mark in state_marks(columns)]
[(0.0, 'enabled'), (0.002, 'fault: stall'), (0.003, 'enabled')]
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from epg.simulate.picture import BLACK, GREEN, ORANGE, Mark

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
"""The columns of a trace from which marks are made."""

MOST = 12
"""The greatest number of marks of one target: a plot with more of them is not readable."""


def state_marks(columns: Mapping[str, Sequence[float]], target: str = "") -> list[Mark]:
    """The marks of one target.  ``columns`` has the columns of its trace; ``target`` is written in front of the text.

    A target that is disabled at the start has no mark there.
    """
    name = f"{target}: " if target else ""
    marks: list[Mark] = []
    enabled, fault = 0.0, 0.0
    for time, now, found in zip(columns["time"], columns["enabled"], columns["fault"]):
        if now == enabled and found == fault:
            continue
        if found not in (0.0, fault):
            marks.append(Mark(time, f"{name}fault: {FAULTS.get(int(found), str(int(found)))}", ORANGE))
        elif now != enabled:
            marks.append(Mark(time, f"{name}enabled", GREEN) if now else Mark(time, f"{name}disabled", BLACK))
        enabled, fault = now, found
    return marks[:MOST]
