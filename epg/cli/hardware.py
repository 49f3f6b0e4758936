# SPDX-License-Identifier: Apache-2.0
"""The assignments of hardware to components, as a table."""

from __future__ import annotations

from collections.abc import Mapping

from epg.cli.table import table
from epg.emit.hardware import hardware_rows
from epg.resolve.allocation import Assignment
from epg.resolve.claims import ClaimKey


def hardware_table(assignments: Mapping[ClaimKey, Assignment]) -> str:
    """A table with one line for each claim."""
    return table(("used by", "hardware", "pins", "frequency", "resolution"), hardware_rows(assignments))
