# SPDX-License-Identifier: Apache-2.0
"""Live for long: 20 signals at 1 kHz lose no row, take no more memory, and never keep the page busy for 100 ms.

The heap of the scripts is one part of the memory.  The processes of a browser also have canvases and their paths, which
Firefox counts for no heap, and collects late.
"""

from __future__ import annotations

import contextlib
import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.live.witness import PROJECT, SIGNALS, Robot, build_robot
from tests.waiting import until

from .acts import NEWEST, let_pass
from .firefox import Firefox
from .served import Served

Open = Callable[..., Any]
MIB = 1 << 20
WARM = 15
"""Seconds until the plots are full, and Chromium has compiled the scripts."""
SAMPLE = 5
"""Seconds between two measurements of the memory."""
TASKS = """() => {
  globalThis.longest = 0;
  new PerformanceObserver((list) => {
    for (const { duration } of list.getEntries()) globalThis.longest = Math.max(globalThis.longest, duration);
  }).observe({ type: "longtask" });
}"""


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[Robot]:
    with Robot(build_robot(tmp_path / "build"), tmp_path) as found:
        yield found


class Computer:
    """How late other programs let an idle thread run: a task of the page takes that much longer, too."""

    def __init__(self) -> None:
        self.late = 0.0
        self._over = threading.Event()
        threading.Thread(target=self._look, daemon=True).start()

    def _look(self) -> None:
        while not self._over.is_set():
            due = time.monotonic() + 0.01  # the witness of a late computer
            time.sleep(0.01)  # the witness of a late computer
            self.late = max(self.late, time.monotonic() - due)  # the witness of a late computer

    def end(self) -> float:
        """Returns the largest delay in milliseconds."""
        self._over.set()
        return 1000 * self.late


def resident(process: int) -> int:
    """The memory of a process, in bytes."""
    found = re.search(r"^VmRSS:\s+(\d+) kB", Path(f"/proc/{process}/status").read_text(), re.MULTILINE)
    assert found is not None
    return int(found[1]) << 10


def family(process: int) -> list[int]:
    """A process and all that it has started, and these."""
    parents: dict[int, list[int]] = {}
    for entry in Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):  # it has ended meanwhile
            parent = int((entry / "stat").read_text().rpartition(")")[2].split()[1])
            parents.setdefault(parent, []).append(int(entry.name))
    found = [process]
    for each in found:
        found += parents.get(each, [])
    return found


def memory(process: int) -> int:
    """The memory of a process and of those that it has started, in bytes; shared memory counts once."""
    total = 0
    for each in family(process):
        with contextlib.suppress(OSError):
            found = re.search(r"^Pss:\s+(\d+) kB", Path(f"/proc/{each}/smaps_rollup").read_text(), re.MULTILINE)
            total += int(found[1]) << 10 if found else 0
    return total


@pytest.mark.parametrize("name", ["chromium", "firefox"])
@pytest.mark.parametrize("seconds", [60, 3600], ids=["minute", "hour"])
def test_the_browser_takes_no_more_memory(robot: Robot, request: Any, name: str, seconds: int) -> None:
    """At most 200 MiB more in an hour.  In a minute it is less than 100 MiB that the browser has not collected yet."""
    chromium = None
    alone: contextlib.AbstractContextManager[None] = contextlib.nullcontext()
    if name == "firefox":
        firefox: Firefox = request.getfixturevalue("firefox")
        firefox.new_tab()
        evaluate, open_, process = firefox.evaluate, firefox.open, firefox.process
        alone = firefox.left_alone()
    else:
        chromium = request.getfixturevalue("launch")()
        page = chromium.new_page(viewport={"width": 1280, "height": 800})
        session = chromium.new_browser_cdp_session()
        found = session.send("SystemInfo.getProcessInfo")["processInfo"]
        evaluate, open_ = page.evaluate, page.goto
        process = next(each["id"] for each in found if each["type"] == "browser")
    try:
        with Served(PROJECT) as epg:
            epg.post("live/connect", path=str(robot.port))
            open_(epg.address)
            until(lambda: evaluate("document.querySelectorAll('.live-signals input').length"))
            evaluate("document.querySelectorAll('.live-signals input:not(:checked)').forEach((each) => each.click())")
            with alone:
                used = []
                for _ in range((2 * WARM + seconds) // SAMPLE):
                    time.sleep(SAMPLE)  # nobody may ask Firefox for the time of the target
                    used.append(memory(process))
                before, most = used[2 * WARM // SAMPLE - 1], max(used[2 * WARM // SAMPLE :])
            newest = evaluate(NEWEST)
    finally:
        if chromium is not None:
            chromium.close()
        else:
            firefox.close_tab()
    summary = f"{name}: {before / MIB:.0f} MiB, then at most {most / MIB:.0f} MiB"
    print(summary)
    assert newest > seconds, "the plots move"
    assert most - before < (200 if seconds == 3600 else 100) * MIB, summary


@pytest.mark.parametrize("seconds", [60, 3600], ids=["minute", "hour"])
def test_20_signals_in_every_cycle(robot: Robot, open_page: Open, seconds: int) -> None:
    with Served(PROJECT) as epg:
        page = open_page(epg.address)
        page.get_by_role("tab", name="Live").click()
        page.get_by_label("Port").fill(str(robot.port))
        page.get_by_role("button", name="Connect", exact=True).click()
        page.get_by_role("tab", name="Live ○ disabled").wait_for()
        page.get_by_role("button", name="Larger").click()
        for box in page.locator(".live-signals input").all():
            box.check()
        target = epg.state()["live"]["target"]
        assert (target["every"], target["period"]) == (1, 0.001)
        assert sum(not signal["loop"] for signal in target["signals"]) == SIGNALS
        assert page.locator(".plots canvas").count() == 2, "one for the signals, one for the times of the loop"
        devtools = page.context.new_cdp_session(page)

        def used() -> int:
            let_pass(page.evaluate, 0.2)
            devtools.send("HeapProfiler.collectGarbage")
            return int(devtools.send("Runtime.getHeapUsage")["usedSize"])

        def heap() -> int:
            """The least of some samples: others contain events that the page has not read yet."""
            return min(used() for _ in range(5))

        let_pass(page.evaluate, WARM)
        before, server = heap(), resident(epg.process)
        computer = Computer()
        page.evaluate(TASKS)
        let_pass(page.evaluate, seconds)
        longest, late = page.evaluate("longest"), computer.end()
        after, grown = heap(), resident(epg.process) - server
        newest = page.evaluate(NEWEST)
        summary = (
            f"heap {before / MIB:.2f} MiB, then {after / MIB:.2f} MiB; longest task {longest:.0f} ms, while "
            f"an idle thread was up to {late:.0f} ms late; server "
            f"{server / MIB:.1f} MiB, then {(server + grown) / MIB:.1f} MiB"
        )
        print(summary)
        assert newest > WARM + seconds - 2, "the plots move"
        assert page.get_by_text(re.compile("rows dropped")).count() == 0
        assert after < before + MIB, summary
        assert longest < 100 + late, summary
        assert grown < 4 * MIB, summary  # rows are on the disk
