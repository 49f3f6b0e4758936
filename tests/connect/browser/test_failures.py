# SPDX-License-Identifier: Apache-2.0
"""Everything between a user and a robot fails, one part at a time, while the robot is enabled or moved by hand.

The actuator notes in which control cycles it was driven.  So the times are those of the target, and do not contain the
time that this computer takes to notice.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from epg.live.client import Client
from epg.live.port import Port
from tests.live import bridge
from tests.live.target import LEASE
from tests.live.witness import CYCLE, PROJECT, Robot, build_robot

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
        self.line = Line(self.robot, folder / "line")
        self.epg = Served(PROJECT)
        self.browser = launch()
        self.page = self.browser.new_page(viewport={"width": 1280, "height": 800})

    def connect(self) -> None:
        self.page.goto(self.epg.address)
        self.page.get_by_role("tab", name="Live").click()
        self.page.get_by_label("Port").fill(str(self.line.port))
        self.page.get_by_role("button", name="Connect", exact=True).click()
        self.page.get_by_role("button", name="Larger").click()
        self.page.get_by_role("button", name="Enable (hold)").wait_for()

    def renderers(self) -> list[int]:
        """The processes that run the pages of the browser."""
        session = self.browser.new_browser_cdp_session()
        found = session.send("SystemInfo.getProcessInfo")["processInfo"]
        return [each["id"] for each in found if each["type"] == "renderer"]

    def close(self) -> None:
        self.line.close()
        self.robot.close()
        self.epg.kill()


def killed(processes: Callable[[Way], list[int]], number: signal.Signals) -> Callable[[Way], float]:
    def act(way: Way) -> float:
        found = processes(way)
        assert found
        for process in found:
            os.kill(process, number)
        return time.monotonic()

    return act


def of_page(way: Way) -> list[int]:
    return way.renderers()


def of_server(way: Way) -> list[int]:
    return [way.epg.process]


def of_line(way: Way) -> list[int]:
    return [way.line.process.pid]


def flooded_and_killed(way: Way) -> float:
    way.line.become(signal.SIGUSR2)
    time.sleep(0.1)
    return killed(of_page, signal.SIGKILL)(way)


FAILURES: dict[str, Callable[[Way], float]] = {
    "page_killed": killed(of_page, signal.SIGKILL),
    "page_stopped": killed(of_page, signal.SIGSTOP),
    "server_killed": killed(of_server, signal.SIGKILL),
    "server_stopped": killed(of_server, signal.SIGSTOP),
    "line_cut": killed(of_line, signal.SIGKILL),
    "line_stopped": killed(of_line, signal.SIGSTOP),
    "line_full_of_garbage": lambda way: way.line.become(signal.SIGUSR1),
    "page_killed_and_garbage_between_frames": flooded_and_killed,
}
"""Each returns the time from which on the page cannot reach the robot any more."""


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return build_robot(tmp_path_factory.mktemp("robot"))


@pytest.fixture
def way(program: Path, tmp_path: Path, launch: Callable[[], Any]) -> Iterator[Way]:
    found = Way(program, tmp_path, launch)
    yield found
    for process in found.renderers():
        os.kill(process, signal.SIGCONT)
    found.browser.close()
    found.close()


def enable(way: Way) -> None:
    way.connect()
    way.page.get_by_role("button", name="Enable (hold)").click(delay=700)
    way.robot.wait(driven=True)


def move(way: Way) -> None:
    way.connect()
    way.page.get_by_role("button", name="Move motor forwards").hover()
    way.page.mouse.down()
    way.robot.wait(driven=True)


@pytest.mark.parametrize("failure", FAILURES)
@pytest.mark.parametrize("begin", [enable, move])
def test_the_actuator_is_safe_within_300_ms_and_a_cycle(way: Way, begin: Callable[[Way], None], failure: str) -> None:
    begin(way)
    way.page.wait_for_timeout(1000)
    assert way.robot.is_driven(), "it is driven for longer than a lease or a pulse"
    at = FAILURES[failure](way)
    way.robot.wait(driven=False)
    (span,) = way.robot.spans()
    assert at < span.last + LEASE, "the failure was the cause"
    assert span.last <= at + LEASE + CYCLE, f"driven for {1000 * (span.last - at):.1f} ms after the failure"


@pytest.mark.parametrize("failure", ["page_closed", *FAILURES])
def test_a_robot_that_another_program_has_enabled_stays_enabled(way: Way, failure: str) -> None:
    with Port(way.line.port) as port:
        client = Client(port)
        client.command("enable")
        client.stop()
    way.robot.wait(driven=True)
    way.connect()
    if failure == "page_closed":
        way.page.close()
    else:
        FAILURES[failure](way)
    time.sleep(2 * LEASE)
    assert [span.begin for span in way.robot.spans() if way.robot.is_driven()] == [way.robot.spans()[0].begin]
