# SPDX-License-Identifier: Apache-2.0
"""Checks that a run ended in the state that its scenario expects.  The default is enabled.

The limits of the axes alone do not show that the controller has worked.  They also hold if the target was never enabled
while its setpoint rests, or if a fault has disabled it after the last window.  A scenario that tests such a stop must
therefore say so.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from epg.generator.dataclass import dataclass


class EndState(Protocol):
    """The state of a target at the end of a run."""

    @property
    def enabled(self) -> bool: ...

    @property
    def fault(self) -> str: ...

    @property
    def fault_component(self) -> str: ...


@dataclass(frozen=True)
class Ending:
    """The result of the check.  ``problem`` is empty if the run ended as expected."""

    problem: str = ""
    hint: str = ""


def how_it_ended(expected: str, enabled: Sequence[float], statistics: EndState) -> Ending:
    """Compares the end of a run with ``expected``, which is ``Scenario.ends``.

    ``enabled`` is the column of the trace: not zero in each cycle in which the target was enabled.
    """
    ever = any(enabled)
    if expected == "never_enabled":
        return Ending("the target was enabled, but the scenario has 'ends: never_enabled'") if ever else Ending()
    if not ever:
        hint = "it starts disabled: add 'events: [{at: 0 s, enable: true}]' to the scenario"
        if statistics.fault != "none":
            hint = f"a fault keeps it disabled: {_reason(statistics)}"
        return Ending(
            "the target was never enabled", hint + "; if the scenario tests this, add 'ends: never_enabled' to it"
        )
    if expected == "disabled":
        return (
            Ending("the target was enabled at the end, but the scenario has 'ends: disabled'")
            if statistics.enabled
            else Ending()
        )
    if not statistics.enabled:
        problem = f"the target was disabled at the end ({_reason(statistics)})"
        return Ending(problem, "if the scenario tests this, add 'ends: disabled' to it")
    return Ending()


def _reason(statistics: EndState) -> str:
    if statistics.fault == "none":
        return "by a request"
    return f"{statistics.fault}: {statistics.fault_component}" if statistics.fault_component else statistics.fault
