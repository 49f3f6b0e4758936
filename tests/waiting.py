# SPDX-License-Identifier: Apache-2.0
"""The one function by which tests wait for something to happen.

It ends as soon as that happens.  Its patience is for a computer that also runs other programs: a test that must judge
how long something takes compares times of the target.

>>> found = []
>>> until(lambda: found.append(1) or len(found) > 2)
True
"""

from __future__ import annotations

import cProfile
import os
import select
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

T = TypeVar("T")

PATIENCE = 30.0  # seconds after which a test gives up


def until(happens: Callable[[], T], what: object = "", seconds: float = PATIENCE, pause: float = 0.01) -> T:
    """Calls ``happens`` every ``pause`` s until its result is true, and returns that result.

    If it does not happen, the error shows ``what``, or the result of ``what`` if that is a function.
    """
    end = time.monotonic() + seconds  # the patience of all tests
    while not (found := happens()):
        assert time.monotonic() < end, what() if callable(what) else what or "it does not happen"  # patience
        time.sleep(pause)  # between two looks
    return found


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


def soon(happens: Callable[[], object], seconds: float, pause: float = 0.01) -> bool:
    """Returns whether it happens within some seconds."""
    try:
        until(happens, seconds=seconds, pause=pause)
    except AssertionError:
        return False
    return True
