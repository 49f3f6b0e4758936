# SPDX-License-Identifier: Apache-2.0
"""Everything between a user and a robot fails, one part at a time, while the robot is enabled or moved by hand.

The actuator notes in which control cycles it was driven.  So the times are those of the target, and do not contain the
time that this computer takes to notice.
"""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable

import pytest

from epg.live.client import Client
from epg.live.port import SerialPort
from tests.live.target import LEASE
from tests.live.witness import CYCLE, Span

from .acts import let_pass
from .way import Way


def killed(processes: Callable[[Way], list[int]], number: signal.Signals) -> Callable[[Way], float]:
    def act(way: Way) -> float:
        found = processes(way)
        assert found
        for process in found:
            os.kill(process, number)
        return time.monotonic()  # the failure's time, compared with the target's

    return act


def of_page(way: Way) -> list[int]:
    return way.renderers()


def of_server(way: Way) -> list[int]:
    return [way.epg.process]


def of_line(way: Way) -> list[int]:
    return [way.line.process.pid]


def flooded_and_killed(way: Way) -> float:
    way.line.become(signal.SIGUSR2)
    let_pass(way.page.evaluate, 0.1)
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


def enable(way: Way) -> None:
    way.connect()
    way.enable()


def move(way: Way) -> None:
    way.connect()
    way.page.locator("button[aria-label='Move motor forwards']:enabled").hover()
    way.page.mouse.down()
    way.robot.wait(driven=True)


def end_of(way: Way, at: float) -> Span:
    """Waits until the actuator is safe, and returns the only time in which it was driven."""
    way.robot.wait(driven=False)
    spans = way.robot.spans()
    assert len(spans) == 1, [tuple(round(1000 * (each - at)) for each in span) for span in spans]
    return spans[0]


@pytest.mark.parametrize("failure", FAILURES)
@pytest.mark.parametrize("begin", [enable, move])
def test_the_actuator_is_safe_within_300_ms_and_a_cycle(way: Way, begin: Callable[[Way], None], failure: str) -> None:
    begin(way)
    let_pass(way.page.evaluate, 1.0)
    assert way.robot.is_driven(), "it is driven for longer than a lease or a pulse"
    at = FAILURES[failure](way)
    span = end_of(way, at)
    assert at < span.last + LEASE, "the failure was the cause"
    assert span.last <= at + LEASE + CYCLE, f"driven for {1000 * (span.last - at):.1f} ms after the failure"


@pytest.mark.parametrize("begin", [enable, move])
def test_what_a_page_has_sent_before_it_was_killed_drives_no_longer(way: Way, begin: Callable[[Way], None]) -> None:
    """On a slow line, its newest answers are still on their way."""
    way.line.become(signal.SIGHUP)
    begin(way)
    let_pass(way.page.evaluate, 1.0)
    assert way.robot.is_driven(), "a slow line alone does not stop it"
    at = killed(of_page, signal.SIGKILL)(way)
    span = end_of(way, at)
    assert at < span.last <= at + LEASE + CYCLE, f"driven for {1000 * (span.last - at):.1f} ms after the failure"


def test_a_robot_that_another_program_has_enabled_stays_enabled(way: Way) -> None:
    with SerialPort(way.line.port) as port:
        client = Client(port)
        client.enable(unattended=True)
        client.stop()
    way.robot.wait(driven=True)
    way.connect()
    way.page.close()
    time.sleep(2 * LEASE)  # no page is left that shows the target's time
    assert [span.begin for span in way.robot.spans() if way.robot.is_driven()] == [way.robot.spans()[0].begin]
