# SPDX-License-Identifier: Apache-2.0
"""The functions by which tests wait for something to happen.

Their patience is for a computer that also runs other programs: a test that must judge how long something takes compares
times of the target.
"""

from __future__ import annotations

import cProfile
import os
import select
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from tests.doubles.waiting import PATIENCE, soon, until

T = TypeVar("T")

__all__ = ["PATIENCE", "calls", "read_until", "soon", "until", "waited"]


def waited(process: int) -> float:
    """Seconds for which the threads of a process were ready to run and had no processor: a late computer."""
    files = Path(f"/proc/{process}/task").glob("*/schedstat")
    return sum(1e-9 * int(file.read_text().split()[1]) for file in files)


def read_until(terminal: int, *texts: str) -> str:
    """What a terminal shows until that contains one of ``texts``.  With none, until its program has ended."""
    seen = ""

    def shows() -> bool:
        nonlocal seen
        if select.select([terminal], [], [], 0.5)[0]:
            try:
                seen += os.read(terminal, 65536).decode("utf-8", "replace")
            except OSError:  # the program has ended
                return not texts
        return any(text in seen for text in texts)

    until(shows, lambda: f"none of {texts}: {seen[-3000:]}", pause=0.0)
    return seen


def calls(act: Callable[[], T]) -> tuple[T, int]:
    """The result of ``act``, and how many functions it has called: its effort, on any computer."""
    profile = cProfile.Profile()
    result = profile.runcall(act)
    return result, sum(entry.callcount for entry in profile.getstats())
