# SPDX-License-Identifier: Apache-2.0
"""A line between a target and a program, as a process of its own: ``bridge.py TARGET_PORT OWN_PORT``.

It passes bytes on in both directions.  SIGUSR1: it sends garbage in both directions instead, as much as both ends take.
SIGUSR2: it sends garbage between the bytes that it passes on.  SIGHUP: it passes bytes on to the target :data:`DELAY`
later.  It prints "ready", and at each signal the monotonic time from which on it acts so.
"""

from __future__ import annotations

import os
import random
import select
import signal
import sys
import time
import tty
from collections import deque
from pathlib import Path

PIECE = 256
"""Bytes of garbage between two looks at the line."""
DELAY = 0.15
"""Seconds that a byte takes on a slow line."""


def main(target: Path, own: Path) -> None:
    mode = "pass"
    draw = random.Random(5)

    def become(new: str) -> None:
        nonlocal mode
        mode = new
        print(time.monotonic(), flush=True)  # the fault's time, compared with the target's

    signal.signal(signal.SIGUSR1, lambda *_: become("garbage"))
    signal.signal(signal.SIGUSR2, lambda *_: become("between"))
    signal.signal(signal.SIGHUP, lambda *_: become("slow"))
    board = os.open(target, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(board)
    near, far = os.openpty()  # `far` stays open: the port exists until this process ends
    tty.setraw(far)
    own.symlink_to(os.ttyname(far))
    other = {board: near, near: board}
    for file in other:
        os.set_blocking(file, False)
    waiting = {board: b"", near: b""}
    under_way: deque[tuple[float, bytes]] = deque()  # on a slow line: the bytes to the target, and when they arrive
    print("ready", flush=True)
    while True:
        noisy = mode in ("garbage", "between")
        writable = [file for file in other if waiting[file] or noisy]
        readable, ready, _ = select.select(list(other), writable, [], 0.001 if under_way else 0.1)
        now = time.monotonic()  # the delay of a slow line
        for file in readable:
            data = os.read(file, 4096)
            if mode == "slow" and other[file] == board:
                under_way.append((now + DELAY, data))
            elif mode != "garbage" and len(waiting[other[file]]) < 65536:
                waiting[other[file]] += data
        while under_way and under_way[0][0] <= now:
            waiting[board] += under_way.popleft()[1]
        for file in ready:
            data = waiting[file] if mode != "garbage" else b""
            garbage = draw.randbytes(PIECE) if noisy else b""
            try:
                sent = os.write(file, data + garbage)
            except BlockingIOError:
                continue
            waiting[file] = data[sent:]


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
