# SPDX-License-Identifier: Apache-2.0
"""Everything between a user and a robot, each part a process of its own, so that a test can stop or end it.

>>> # way = Way(program, folder, launch); way.connect(); way.enable(); os.kill(way.epg.process, signal.SIGSTOP)
"""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from tests.doubles.network import bridge
from tests.live.witness import PROJECT, Robot
from tests.waiting import PATIENCE, until

from .acts import drive, late, processes
from .served import Served


class Line:
    """The bridge between the robot and the server."""

    def __init__(self, robot: Robot, port: Path) -> None:
        self.port = port
        command = [sys.executable, bridge.__file__, str(robot.port), str(port)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self._said() == "ready"

    def _said(self) -> str:
        assert self.process.stdout is not None
        return self.process.stdout.readline().strip()

    def become(self, number: signal.Signals) -> float:
        """Makes the line worse; returns the time from which on it is."""
        self.process.send_signal(number)
        return float(self._said())

    def close(self) -> None:
        self.process.kill()
        self.process.communicate()


class Way:
    """A robot, its line, EPG's server, and a browser with its page."""

    def __init__(self, program: Path, folder: Path, launch: Callable[[], Any]) -> None:
        self.robot = Robot(program, folder)
        self._line = folder / "line"
        self.line = Line(self.robot, self._line)
        self.epg = Served(PROJECT)
        self.browser = launch()
        self.page = self.browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
        self.page.set_default_timeout(1000 * PATIENCE)

    def connect(self) -> None:
        self.page.goto(self.epg.address)
        self.page.get_by_role("tab", name="Live").click()
        self.page.get_by_label("Port").fill(str(self.line.port))
        self.page.get_by_role("button", name="Connect", exact=True).click()
        self.page.get_by_role("button", name="Larger").click()
        self.page.get_by_role("button", name="Enable (hold)").wait_for()

    def reconnect_line(self) -> None:
        """Puts the cable in again."""
        self._line.unlink()
        self.line.close()
        self.line = Line(self.robot, self._line)

    def enable(self) -> None:
        """Enables the robot on a lease, as a user does."""
        button = self.page.get_by_role("button", name="Enable (hold)")
        drive(lambda: button.click(delay=700), self.robot.is_driven, self.browser, self.epg.process)
        self.bar.get_by_text("robot enabled").wait_for()

    def send(self, line: str) -> None:
        """Types a line into the field of the console."""
        self.page.locator("#live-command").fill(line)
        self.page.locator("#live-command").press("Enter")

    def enable_unattended(self) -> None:
        """Enables the robot without a lease."""
        self.page.get_by_role("tab", name="Live ○ disabled").wait_for()

        def act() -> None:
            self.page.locator("#panel button.hold:enabled:not([aria-disabled])").wait_for()
            self.send("enable unattended")
            self.page.get_by_role("dialog").get_by_role("button", name="Enable unattended").click()

        drive(act, self.robot.is_driven, self.browser, self.epg.process)
        self.bar.get_by_text("robot enabled unattended").wait_for()

    @property
    def bar(self) -> Any:
        """The bar of the robot, above everything else."""
        return self.page.get_by_role("region", name="Running robot")

    def renderers(self) -> list[int]:
        """The processes that run the pages of the browser."""
        return [each["id"] for each in processes(self.browser) if each["type"] == "renderer"]

    def late(self) -> float:
        """Seconds for which this test, the browser and EPG had no processor so far."""
        return late(self.browser, self.epg.process)

    def stops_within(self, seconds: float, what: str = "") -> None:
        """Waits until the robot is not driven, for some seconds and the time in which the computer was late."""
        late, begin = self.late(), time.monotonic()  # the time that a user waits
        until(lambda: not self.robot.is_driven(), what)
        assert time.monotonic() - begin < seconds + self.late() - late, what  # the time that a user waits

    def close(self) -> None:
        for process in (*self.renderers(), self.epg.process, self.robot.process.pid):
            with contextlib.suppress(ProcessLookupError):  # the test has ended it
                os.kill(process, signal.SIGCONT)
        self.browser.close()
        self.line.close()
        self.robot.close()
        self.epg.kill()
