# SPDX-License-Identifier: Apache-2.0
"""Live for long: 20 signals at 1 kHz lose no row, take no more memory, and never keep the page busy for 100 ms."""

from __future__ import annotations

import re
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.live.witness import PROJECT, SIGNALS, Robot, build_robot

from .served import Served

Open = Callable[..., Any]
MIB = 1 << 20
WARM = 15
"""Seconds until the plots are full, and Chromium has compiled the scripts."""
HISTORY = 4_000_000 * 4 + 4_000_000 / 22 * 8
"""Bytes of the values and times that the server keeps at most."""
ROW = 22 * 4 + 8
"""Bytes of a row: the signals, two of the loop, and the time."""
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
            due = time.monotonic() + 0.01
            time.sleep(0.01)
            self.late = max(self.late, time.monotonic() - due)

    def end(self) -> float:
        """Returns the largest delay in milliseconds."""
        self._over.set()
        return 1000 * self.late


def resident(process: int) -> int:
    """The memory of a process, in bytes."""
    found = re.search(r"^VmRSS:\s+(\d+) kB", Path(f"/proc/{process}/status").read_text(), re.MULTILINE)
    assert found is not None
    return int(found[1]) << 10


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
            page.wait_for_timeout(200)
            devtools.send("HeapProfiler.collectGarbage")
            return int(devtools.send("Runtime.getHeapUsage")["usedSize"])

        def heap() -> int:
            """The least of some samples: others contain events that the page has not read yet."""
            return min(used() for _ in range(5))

        page.wait_for_timeout(1000 * WARM)
        before, server = heap(), resident(epg.process)
        begin = time.monotonic()
        computer = Computer()
        page.evaluate(TASKS)
        page.wait_for_timeout(1000 * seconds)
        longest, late = page.evaluate("longest"), computer.end()
        after, grown = heap(), resident(epg.process) - server
        kept = min(ROW * 1000 * (time.monotonic() - begin), HISTORY)
        newest = page.evaluate("(async () => (await import(new URL('live_events.js', location))).live.times.at(-1))()")
        summary = (
            f"heap {before / MIB:.2f} MiB, then {after / MIB:.2f} MiB; longest task {longest:.0f} ms, while "
            f"an idle thread was up to {late:.0f} ms late; server "
            f"{server / MIB:.1f} MiB, then {(server + grown) / MIB:.1f} MiB, of which {kept / MIB:.1f} MiB are new rows"
        )
        print(summary)
        assert newest > WARM + seconds - 2, "the plots move"
        assert page.get_by_text(re.compile("rows dropped")).count() == 0
        assert after < before + MIB, summary
        assert longest < 100 + late, summary
        assert grown < 1.5 * kept + 4 * MIB, summary
