# SPDX-License-Identifier: Apache-2.0
"""The fault of a lease that has ended names who was late: the page, EPG's server, the line, or the target."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from .acts import let_pass
from .way import Way

PARTS: dict[str, Callable[[Way], list[int]]] = {
    "page": lambda way: way.renderers(),
    "server": lambda way: [way.epg.process],
    "line": lambda way: [way.line.process.pid],
    "target": lambda way: [way.robot.process.pid],
}
TEXTS = {
    "page": "The page was late: it did not answer for",
    "server": "EPG on this computer was late: it stood still for",
    "line": "The line was late: nothing arrived from the target for",
    "target": "The target was late: it stood still for",
}


@pytest.mark.parametrize("late", PARTS)
def test_who_was_late(way: Way, late: str) -> None:
    way.connect()
    for _ in range(5):  # on a computer with high load, the page can be late before
        way.enable()
        let_pass(way.page.evaluate, 1.0)
        if way.robot.is_driven():
            break
    processes = PARTS[late](way)
    for process in processes:
        os.kill(process, signal.SIGSTOP)
    time.sleep(1.2)  # the fault: a part stands still
    for process in processes:
        os.kill(process, signal.SIGCONT)
    state = way.epg.until(lambda state: "was late" in (state["live"]["target"]["fault"] or {}).get("text", ""))
    fault = state["live"]["target"]["fault"]
    assert TEXTS[late] in fault["text"]
    assert fault["remedy"].endswith(" enable the target again.")
    way.page.get_by_role("alert").get_by_text(TEXTS[late]).wait_for()
