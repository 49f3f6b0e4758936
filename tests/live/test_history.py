# SPDX-License-Identifier: Apache-2.0
"""The kept rows of a stream, and recordings as the console sends them."""

from __future__ import annotations

import errno
import threading
from pathlib import Path

import pytest

from epg.live.capture import CaptureProgress, progress_of, recorded_of
from epg.live.history import History
from epg.runs.recording import Row


def test_the_newest_rows_are_kept(tmp_path: Path) -> None:
    history = History(2, most=500 * 16)
    assert (history.newest, list(history.rows())) == (None, [])
    for block in range(100):
        history.write([Row(number / 1000, [number, -number]) for number in range(10 * block, 10 * block + 10)])
    kept = [(row.time, *row.values) for row in history.rows()]
    first = 1000 - history.count
    assert 500 <= first <= 700
    assert kept == [(number / 1000, number, -number) for number in range(first, 1000)]
    assert history.size == history.count * 16
    assert history.since == history.begin + first * 1_000_000
    assert [row.time for row in history.rows(0.998)] == [0.998, 0.999]
    assert history.newest == 0.999
    assert abs(1e9 * tmp_path.stat().st_mtime - history.begin) < 60e9


def test_old_rows_go_when_the_disk_is_full(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    with monkeypatch.context() as full:
        full.setattr("epg.live.history._PART", 12)
        history = History(1, most=1 << 20, folder=tmp_path)
        history.write([Row(0.0, [1.0])])
        history.write([Row(0.1, [2.0])])
        assert [row.time for row in history.rows()] == [0.0, 0.1]
        full.setattr("epg.live.history.FREE", 1 << 62)
        history.write([Row(0.2, [3.0])])
        assert [row.time for row in history.rows()] == [0.2]
        full.setattr("tempfile.TemporaryFile", no_room)
        history.write([Row(0.3, [3.0])])
        assert (list(history.rows()), history.problem) == ([], "No space left on device")
    history.write([Row(0.4, [3.0])])
    assert ([row.time for row in history.rows()], history.problem) == ([0.4], "")
    history.close()
    assert history.count == 0
    assert list(tmp_path.iterdir()) == []


def no_room(**_options: object) -> None:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_rows_are_read_while_others_are_written() -> None:
    history = History(1, most=500 * 12)
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
    assert progress_of("ok capture state=recording rows=50") == CaptureProgress(True, 50, None)
    assert progress_of("ok capture state=ready rows=3 trigger=1") == CaptureProgress(False, 3, 1)
    lines = ["csv time,inputs.a", "csv 2.5,1", "csv 2.501,nan", "csv 2.502,-1e-3", "ok capture"]
    found = recorded_of(lines, 1)
    assert (found.names, found.triggered) == (("inputs.a",), True)
    assert [row.time for row in found.rows] == [-0.001, 0.0, 0.001]
    assert [row.values for row in found.rows] == [[1.0], pytest.approx([float("nan")], nan_ok=True), [-0.001]]
    assert recorded_of(lines, None).rows[0].time == 0.0
    assert recorded_of(lines[:1], None).rows == []
