# SPDX-License-Identifier: Apache-2.0
"""What a simulation gives."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from epg.diagnostics import Diagnostics
from epg.simulate.ends import Ending
from epg.simulate.executable import Statistics
from epg.simulate.tracking import Check, WindowResult


@dataclass(frozen=True)
class Result:
    """``files`` lists what was written, ``diagnostics`` holds warnings only."""

    statistics: Statistics
    ending: Ending
    windows: tuple[WindowResult, ...]
    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    diagnostics: Diagnostics

    @property
    def passed(self) -> bool:
        """Whether the run ended in the state that the scenario expects, and every limit holds."""
        return not self.ending.problem and all(check.passed for check in self.checks)
