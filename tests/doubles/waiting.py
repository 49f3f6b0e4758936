# SPDX-License-Identifier: Apache-2.0
"""Waiting for something to happen: it ends as soon as that happens.

>>> found = []
>>> until(lambda: found.append(1) or len(found) > 2)
True
"""

from __future__ import annotations

import time
from collections.abc import Callable
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


def soon(happens: Callable[[], object], seconds: float, pause: float = 0.01) -> bool:
    """Returns whether it happens within some seconds."""
    try:
        until(happens, seconds=seconds, pause=pause)
    except AssertionError:
        return False
    return True
