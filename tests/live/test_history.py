# SPDX-License-Identifier: Apache-2.0
"""The kept rows of a stream, and recordings as the console sends them."""

from __future__ import annotations

import threading
import time

import pytest

from epg.live.capture import Progress, progress_of, recorded_of
from epg.live.history import History
from epg.live.rows import Row


def test_the_newest_rows_are_kept() -> None:
    history = History(2, most=1000)
    assert (history.newest, list(history.rows())) == (None, [])
    for block in range(100):
        history.write([Row(number / 1000, [number, -number]) for number in range(10 * block, 10 * block + 10)])
    kept = [(row.time, *row.values) for row in history.rows()]
    assert kept == [(number / 1000, number, -number) for number in range(500, 1000)]
    assert [row.time for row in history.rows(0.998)] == [0.998, 0.999]
    assert history.newest == 0.999
    assert abs(time.time_ns() - history.begin) < 60e9


def test_rows_are_read_while_others_are_written() -> None:
    history = History(1, most=500)
    over = threading.Event()

    def write() -> None:
        number = 0
        while not over.is_set():
            history.write([Row(number, [number % 1024])])
            number += 1

    thread = threading.Thread(target=write)
    thread.start()
    try:
        for _ in range(50):
            times = [row.time for row in history.rows()]
            assert times == list(range(int(times[0]), int(times[0]) + len(times))) if times else True
            assert len(times) <= 500
    finally:
        over.set()
        thread.join()


def test_recordings_of_the_console() -> None:
    assert progress_of("ok capture state=recording rows=50") == Progress(True, 50, None)
    assert progress_of("ok capture state=ready rows=3 trigger=1") == Progress(False, 3, 1)
    lines = ["csv time,inputs.a", "csv 2.5,1", "csv 2.501,nan", "csv 2.502,-1e-3", "ok capture"]
    found = recorded_of(lines, 1)
    assert (found.names, found.triggered) == (("inputs.a",), True)
    assert [row.time for row in found.rows] == [-0.001, 0.0, 0.001]
    assert [row.values for row in found.rows] == [[1.0], pytest.approx([float("nan")], nan_ok=True), [-0.001]]
    assert recorded_of(lines, None).rows[0].time == 0.0
    assert recorded_of(lines[:1], None).rows == []
