# SPDX-License-Identifier: Apache-2.0
"""The files of runs have the same bytes as those of earlier versions of EPG."""

from __future__ import annotations

import math
from array import array
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace as Some
from typing import Any

import pytest

from epg import __version__
from epg.generator.diagnostics import Diagnostics
from epg.live.replay_file import ReplayFile
from epg.ros.messages import library_of
from epg.ros.rosbag2 import open_rosbag2
from epg.runs.csv_file import CsvFile
from epg.runs.mcap_file import McapRows
from epg.runs.recording import Row, read_recording, read_table
from epg.runs.setpoint_file import write_setpoints
from epg.runs.tracking import Tracking, write_tracking

THIRD = 1 / 3


def test_rows_of_a_stream(tmp_path: Path) -> None:
    with CsvFile(tmp_path / "live.csv", ["a", "b"]) as file:
        file.write([Row(0.0, array("f", [-52407076.0, THIRD])), Row(0.0010004, (math.nan, -math.inf))])
    expected = b"time,a,b\n0.000000,-52407076,0.333333343\n0.001000,nan,-inf\n"
    assert (tmp_path / "live.csv").read_bytes() == expected


def test_a_recording_for_a_replay(tmp_path: Path) -> None:
    names = [[Some(name=name) for name in some] for some in (["inputs.a", "outputs.b"], ["kp", "Pan\\PID\\kd"])]
    facts = {"name": "jiwy", "node": "n", "version": "1", "hash": "h", "model": "m", "period": 0.001}
    client: Any = Some(description=Some(**facts, signals=names[0], parameters=names[1]))
    file = ReplayFile(tmp_path / "run.csv", client)
    rows = [
        (0, 0, 0.0, 0, 0),
        (1, 0, 0.0, 0, 1),
        (2, 1, 0.1, 1, 0),
        (3, 0, 0.0, 0, 1),
        (4, 2, 5.5, 3, 0),
        (5, -1, 0, 0, 0),
    ]
    file.write(Row(number / 1000, (THIRD, 1e-300, *map(float, row)), number) for number, row in enumerate(rows))
    file.close()
    first, *lines = (tmp_path / "run.csv").read_text().splitlines()
    begin = '# epg recording 1 {"name": "jiwy", "node": "n", "epg": "1", "hash": "h", "model": "m", "period": 0.001, '
    assert first.startswith(begin + '"begin": "2')
    assert lines == [
        "time,cycle,inputs.a,outputs.b,changes",
        "0.000000000,0,0.3333333333333333,1e-300,",
        "0.001000000,1,0.3333333333333333,1e-300,kp=0.1",
        "0.002000000,2,0.3333333333333333,1e-300,",
        "0.003000000,3,0.3333333333333333,1e-300,Pan\\PID\\kd=5.5",
        "0.004000000,4,0.3333333333333333,1e-300,",
        "0.005000000,5,0.3333333333333333,1e-300,?",
    ]
    found = read_table(tmp_path / "run.csv")
    assert (found.model, found.changes) == ("m", {1: "kp=0.1", 3: "Pan\\PID\\kd=5.5", 5: "?"})


def test_tracking_and_setpoints(tmp_path: Path) -> None:
    pan, tilt = Some(name="pan"), Some(name="tilt")
    times = [0.0, 0.001]
    one = Tracking(pan, times, [1.0, 2.0], [1.5, math.inf], [math.nan, 1e-17], None)  # type: ignore[arg-type]
    other = Tracking(tilt, [0.0005], [1.0], [0.1], None, [-0.0])  # type: ignore[arg-type]
    write_tracking([one, other], tmp_path / "tracking.csv")
    assert (tmp_path / "tracking.csv").read_bytes() == (
        b"time,pan_setpoint,pan_reference,pan_position,tilt_setpoint,tilt_position,tilt_duty\n"
        b"0.0,1.0,,1.5,,,\n0.0005,,,,1.0,0.1,-0.0\n0.001,2.0,1e-17,inf,,,\n"
    )
    rows = [(Fraction(0), "$enable", 1.0), (Fraction(1, 3), "pan", 0.1), (Fraction(1, 2), "$component:stop", "open")]
    write_setpoints(rows, tmp_path / "setpoints.csv")  # type: ignore[arg-type]
    expected = b"time,topic,value\n0.0,$enable,1.0\n0.3333333333333333,pan,0.1\n0.5,$component:stop,open\n"
    assert (tmp_path / "setpoints.csv").read_bytes() == expected


def test_setpoints_with_levels_of_inputs_are_a_recording(tmp_path: Path) -> None:
    """``epg simulate`` writes them; a level is a text."""
    (tmp_path / "setpoints.csv").write_text("time,topic,value\n0.0,pan,0.1\n0.5,$component:stop,open\n")
    diagnostics = Diagnostics()
    found = read_recording(tmp_path, diagnostics)
    assert found is not None and list(found.signals) == ["pan"], list(diagnostics)


def test_mcap(tmp_path: Path) -> None:
    writer = pytest.importorskip("mcap.writer", reason="mcap is not installed: pip install mcap")
    rows = [Row(number / 1000, (number * THIRD, -number)) for number in range(50)]
    file = McapRows(tmp_path / "live.mcap", ("a", "b"), "/robot", 1_700_000_000_000_000_000)
    file.write(rows[:20])
    file.flush()
    file.write(rows[20:])
    file.close()
    with (tmp_path / "expected").open("wb") as stream:
        expected = writer.Writer(stream)
        expected.start(profile="", library=f"epg {__version__}")
        schema = b'{"type": "object", "properties": {"a": {"type": "number"}, "b": {"type": "number"}}}'
        channel = expected.register_channel(
            "/robot", "json", expected.register_schema("epg.signals", "jsonschema", schema)
        )
        for number, row in enumerate(rows):
            stamp = 1_700_000_000_000_000_000 + number * 1_000_000
            data = f'{{"a": {row.values[0]!r}, "b": {float(row.values[1])!r}}}'.encode()
            if number == 20:
                expected.flush()
            expected.add_message(channel, stamp, data, stamp)
        expected.finish()
    assert (tmp_path / "live.mcap").read_bytes() == (tmp_path / "expected").read_bytes()


def test_mcap_of_rosbag2(tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader", reason="mcap is not installed: pip install mcap")
    library = library_of(Some(messages={}), "std_msgs/msg/Float64")  # type: ignore[arg-type]
    assert library is not None
    topics = [(name, "std_msgs/msg/Float64", qos, library) for name, qos in (("/a", "reliable"), ("/b", "best_effort"))]
    file, channels = open_rosbag2(tmp_path / "run.mcap", topics)
    file.write(channels[1], b"\0\1\0\0" + bytes(8), 7, 5, 1)
    file.close()
    with (tmp_path / "run.mcap").open("rb") as stream:
        found = reader.make_reader(stream)
        assert (found.get_header().profile, found.get_header().library) == ("ros2", f"epg {__version__}")
        summary = found.get_summary()
        assert [schema.encoding for schema in summary.schemas.values()] == ["ros2msg"]
        qos = [channel.metadata["offered_qos_profiles"] for channel in summary.channels.values()]
        assert [text.splitlines()[2] for text in qos] == ["  reliability: 1", "  reliability: 2"]
        ((_, channel, message),) = found.iter_messages()
    assert (channel.topic, channel.message_encoding) == ("/b", "cdr")
    assert (message.log_time, message.publish_time, message.sequence) == (7, 5, 1)
