# SPDX-License-Identifier: Apache-2.0
"""Recordings: every form of a CSV file is read as the same signals."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.runs.recording import Recording, WrongRecording, read_recording, read_table

FACTS = '# epg recording 1 {"name": "jiwy", "model": "0123", "period": 0.001}\n'


def read(path: Path) -> dict[str, list[tuple[float, float]]]:
    diagnostics = Diagnostics()
    recording = read_recording(path, diagnostics)
    assert recording is not None, list(diagnostics)
    return {name: list(zip(signal.time, signal.value)) for name, signal in recording.signals.items()}


def test_each_form_has_the_same_signals(tmp_path: Path) -> None:
    """Those of simulate, of ``epg live --csv``, of a spreadsheet, of ``epg live --record`` and of ``epg record``."""
    texts = {
        "trace.csv": "time,a,b\n0,1,0.5\n0.1,2,0.25\n",
        "live.csv": "time,a,b\n0.000000,1,0.5\n0.100000,2,0.25\n",
        "own.csv": 'a,"time",b\r\n1,0,0.5\r\n\r\n"2",0.1,2.5e-1\r\n',
        "record.csv": FACTS + "time,a,b,changes\n0.0,1.0,0.5,kp=2 ki=3\n0.1,2.0,0.25,\n",
        "topics.csv": "time,topic,value\n0,a,1\n0,b,0.5\n0,$enable,1\n0.1,a,2\n0.1,b,0.25\n",
    }
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8", newline="")
        assert read(tmp_path / name) == {"a": [(0.0, 1.0), (0.1, 2.0)], "b": [(0.0, 0.5), (0.1, 0.25)]}, name


def test_a_value_that_is_missing_has_no_point_but_a_place_in_a_table(tmp_path: Path) -> None:
    file = tmp_path / "tracking.csv"
    file.write_text("time,a,b\n0,,1\n0.1,2,\n0.2,3,inf\n", encoding="utf-8")
    assert read(file) == {"a": [(0.1, 2.0), (0.2, 3.0)], "b": [(0.0, 1.0)]}
    table = read_table(file).signals
    assert math.isnan(table["a"].value[0]) and list(table["a"].value)[1:] == [2.0, 3.0]
    assert table["b"].value[2] == math.inf
    assert table["a"].time is table["b"].time and list(table["a"].time) == [0.0, 0.1, 0.2]


def test_a_recording_for_a_replay_has_facts_and_changes(tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    file.write_text(FACTS + "time,cycle,inputs.a,changes\n0.5,1,1e-300,kp=2 ki=3\n0.25,2,nan,?\n0.3,3,0.1,\n0.4,4,0")
    found = read_table(file, lambda name: name != "cycle")
    assert (found.model, found.period, found.first) == ("0123", 0.001, 3)
    assert found.changes == {0: "kp=2 ki=3", 1: "?"}
    assert list(found.signals) == ["inputs.a"]
    signal = found.signals["inputs.a"]
    assert list(signal.time) == [0.5, 0.25, 0.3], "the times of a replay are not judged; the last line was cut off"
    assert signal.value[0] == 1e-300 and math.isnan(signal.value[1])


@pytest.mark.parametrize(
    ("text", "id", "problem", "line"),
    [
        ("", "not-a-recording", "this is not a recording: its first line does not name a column 'time'", 1),
        ("time,a", "not-a-recording", "this is not a recording: its first line does not name a column 'time'", 1),
        (FACTS + "time,a\n", "not-a-recording", "this is not a recording: its first line does not name", 2),
        ("# epg recording 1 {}\ntime,changes\n", "wrong-recording", "the facts in this line are damaged", 1),
        ("time,a\n0,1\n\n0.1,1,2\n", "wrong-recording", "this row has 3 columns, not 2", 4),
        ("time,a\n0,1\n,2\n", "wrong-recording", "'' is not a number", 3),
        (FACTS + "time,a,changes\n0,x,\n", "wrong-recording", "'x' is not a number", 3),
        ("time,topic,value\n0,a,\n", "wrong-recording", "'' is not a number", 2),
    ],
)
def test_the_place_of_damage(text: str, id: str, problem: str, line: int, tmp_path: Path) -> None:
    file = tmp_path / "run.csv"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(WrongRecording) as wrong:
        read_table(file)
    assert (wrong.value.id, str(wrong.value)[: len(problem)], wrong.value.line) == (id, problem, line)
    diagnostics = Diagnostics()
    assert read_recording(file, diagnostics) is None
    assert [(item.id, item.span.line) for item in diagnostics.items] == [(id, line)]


def test_a_span_is_that_of_a_row(tmp_path: Path) -> None:
    assert Recording(tmp_path, {}, first=3).span(2).line == 5
