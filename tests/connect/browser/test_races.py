# SPDX-License-Identifier: Apache-2.0
"""Stop on the page, right behind requests to enable: whatever is read when, no request from before it acts after it."""

from __future__ import annotations

import os
import random
import signal
import socket
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.live.witness import PROJECT, Robot

from .acts import let_pass, until
from .served import Served

READY = "document.querySelector('button.hold:enabled') !== null"
HELD = 0.02  # seconds
QUIET = 0.03  # seconds

# Sends requests to enable, and waits for no answer.
SEND = """async (wanted) => {
  const { request } = await import(new URL('live_commands.js', location));
  const { page, live } = await import(new URL('live_events.js', location));
  const after = live.state.stop;
  window.sent = wanted.map((unattended) =>
    unattended ? request('command', { page, line: 'enable unattended', after, unattended })
               : request('enable', { page, after }));
}"""


def confirms(response: Any) -> bool:
    """A click sends two stops, and the target may answer only one of them with ``ok``."""
    return bool(response.url.endswith("/api/live/stop") and response.ok)


@pytest.mark.parametrize("rounds", [200, 1000])
def test_no_enable_from_before_a_stop_acts_after_it(
    robot_program: Path, tmp_path: Path, open_page: Callable[..., Any], rounds: int
) -> None:
    """The answer to a stop says that the target has taken it: each cycle that begins later is disabled."""
    chance = random.Random(rounds)
    with Robot(robot_program, tmp_path, udp=True) as robot, Served(PROJECT) as epg:
        epg.post("live/connect", path=str(robot.port))
        page = open_page(epg.address)
        page.get_by_role("tab", name="Live").click()
        other = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        other.connect(("127.0.0.1", int(str(robot.port).rpartition(":")[2])))
        moved = 0
        for number in range(rounds):
            until(page, READY, 20)
            box = page.get_by_role("button", name="Stop robot").bounding_box()
            before = len(robot.spans())
            held = chance.random() < 0.3
            if chance.random() < 0.3:
                other.send(b"enable\n")
            if held:
                os.kill(robot.process.pid, signal.SIGSTOP)
            page.evaluate(SEND, [chance.random() < 0.5 for _ in range(chance.randint(1, 4))])
            time.sleep(chance.choice([0.0, 0.0, chance.uniform(0, 0.02)]))  # any phase of the control cycle
            with page.expect_response(confirms):
                if number % 2:
                    page.keyboard.press("Space")
                else:
                    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
                if held:
                    time.sleep(HELD)  # the requests reach the target meanwhile
                    os.kill(robot.process.pid, signal.SIGCONT)
            confirmed = time.monotonic()  # the answer's time, compared with the target's
            robot.wait(driven=False)
            page.evaluate("Promise.all(window.sent)")
            let_pass(page.evaluate, QUIET)
            spans = robot.spans()
            assert not robot.is_driven(), number
            assert all(span.last < confirmed for span in spans), (number, confirmed, spans[-1])
            moved += len(spans) > before
        assert moved > rounds / 4, "many of the requests act before the stop"
