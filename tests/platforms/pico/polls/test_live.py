# SPDX-License-Identifier: Apache-2.0
"""The page's *Live* and an RP2040: watched, tuned and stopped over USB through the page's server, and no tick is late.

A terminal of this computer takes the place of the serial port.  The board's time is slower than the page's.
"""

from __future__ import annotations

import os
import select
import threading
import tty
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tests.connect.page import serving, session_of
from tests.connect.test_live import Events
from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import images, skip_unless_emulated
from tests.waiting import until

from .measure import CONSOLE, _polls, _started

ROOT = Path(__file__).resolve().parents[4]
STEP = 5
"""Milliseconds of the board between two looks at the terminal."""


@contextmanager
def terminal(pico: Emulator) -> Iterator[Path]:
    """A terminal whose bytes are those of the console's port.  The board runs meanwhile."""
    own, other = os.openpty()
    tty.setraw(other)
    os.set_blocking(own, False)
    over = threading.Event()

    def run() -> None:
        while not over.is_set():
            try:
                pico.send(os.read(own, 4096), port=CONSOLE)
            except BlockingIOError:
                pass
            pico.run(milliseconds=STEP)
            data = pico.receive_bytes(port=CONSOLE)
            while data:
                try:
                    data = data[os.write(own, data) :]
                except BlockingIOError:
                    select.select([], [own], [], 1.0)

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield Path(os.ttyname(other))
    finally:
        over.set()
        thread.join()
        os.close(own)
        os.close(other)


def test_a_board_is_tuned_and_stopped_through_the_page() -> None:
    skip_unless_emulated("bare_metal")
    elf = images("pico", "bare_metal", "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    session = session_of(ROOT / "examples/jiwy")
    with _started(elf, 3) as pico:
        pico.call("usb_open", port=CONSOLE)
        pico.run(milliseconds=STEP)
        with terminal(pico) as port, serving(session) as page:
            session.live.connect(port, expected="")
            events = Events(page)
            page.post("live/stop")
            events.wait_until_in_time()
            page.post("live/enable", page="one")
            moves(events)
            assert page.post("live/command", page="one", line="set Pan\\PID\\kp=2.2")["answer"] == ["ok set"]
            found = page.state()["live"]["target"]
            assert found["state"]["enabled"] == "1"
            (gain,) = (each for each in found["parameters"] if each["name"] == "Pan\\PID\\kp")
            assert gain["value"] == 2.2
            moves(events)
            page.post("live/stop")
            page.until(lambda state: state["live"]["target"]["state"]["enabled"] == "0", 20)
            assert page.state()["live"]["target"]["state"]["fault"] == "none"
            assert events.all[-1]["dropped"] == 0
            page.post("live/disconnect")
        polls = _polls(pico, "the page")
        assert polls.faults == 0
        assert polls.ticks > 100
        assert polls.deviations == {0}, polls


def moves(events: Events) -> None:
    """Waits until the position of the first axis changes."""
    first = len(events.all)
    until(
        lambda: len({point[2][0] for event in events.all[first:] for point in event["points"]}) > 2, "it does not move"
    )
