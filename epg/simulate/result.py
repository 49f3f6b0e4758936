# SPDX-License-Identifier: Apache-2.0
"""The result of a simulation."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.runs.ending import Ending
from epg.runs.executable import Statistics
from epg.runs.tracking import Check, WindowResult


@dataclass(frozen=True)
class SimulationResult:
    """The result of one run.  ``files`` are the files that were written.  ``diagnostics`` contains only warnings."""

    statistics: Statistics
    ending: Ending
    windows: tuple[WindowResult, ...]
    checks: tuple[Check, ...]
    files: tuple[Path, ...]
    diagnostics: Diagnostics

    @property
    def passed(self) -> bool:
        """True if the run ended in the state that the scenario expects, and all its limits hold."""
        return not self.ending.problem and all(check.passed for check in self.checks)

    def data(self) -> dict[str, Any]:
        """The result for programs, as JSON holds it."""
        return {
            "statistics": asdict(self.statistics),
            "windows": [asdict(window) for window in self.windows],
            "checks": [asdict(check) for check in self.checks],
            "ending": asdict(self.ending),
        }
