# SPDX-License-Identifier: Apache-2.0
"""A serial cable: two pseudo terminals, and a thread that carries bytes from each to the other."""

from __future__ import annotations

import contextlib
import os
import select
import threading
import tty


class Cable:
    """``ends`` are the paths of the two terminals."""

    def __init__(self) -> None:
        pairs = [os.openpty() for _ in range(2)]
        self._masters = [master for master, _ in pairs]
        self._slaves = [slave for _, slave in pairs]
        for master, slave in pairs:
            tty.setraw(slave)
            os.set_blocking(master, False)
        self.ends = [os.ttyname(slave) for slave in self._slaves]
        self._ending = threading.Event()
        self._thread = threading.Thread(target=self._carry, daemon=True)
        self._thread.start()

    def _carry(self) -> None:
        while not self._ending.is_set():
            for master in select.select(self._masters, [], [], 0.05)[0]:
                other = self._masters[1 - self._masters.index(master)]
                with contextlib.suppress(OSError):  # bytes that the other end does not read are lost
                    os.write(other, os.read(master, 4096))

    def __enter__(self) -> Cable:
        return self

    def __exit__(self, *_: object) -> None:
        self._ending.set()
        self._thread.join()
        for file in (*self._masters, *self._slaves):
            os.close(file)
