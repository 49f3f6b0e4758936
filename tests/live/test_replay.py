# SPDX-License-Identifier: Apache-2.0
"""``epg live --record`` and ``epg replay``: running host programs are recorded, and replayed bit for bit."""

from __future__ import annotations

import json
import math
import re
import shlex
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from epg.live.client import CommandRefused, StreamedSignal, TargetDescription
from epg.live.replay_file import signals_to_record

from .replays import ROOT, Text, cells, epg, record, record_at_terminal
from .target import Target

KP = "Pan\\PID\\kp"


@contextmanager
def running(program: Path, folder: Path) -> Iterator[Target]:
    target = Target(program, folder)
    try:
        yield target
    finally:
        target.process.kill()
        target.process.communicate()


@pytest.fixture(scope="session")
def recorded(programs: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Some seconds of JIWY from its enabling on: it finds its zero position and moves, while parameters change."""
    folder = tmp_path_factory.mktemp("recorded")
    with running(programs / "jiwy_host", folder) as target:
        first = [(0.1, f"set {KP}=2.5"), (0.3, "enable")]
        later = [(4.5, "pan_subscriber=0.5 tilt_subscriber=0.3"), (4.6, f"set {KP}=2.25 Tilt\\PID\\kp=1.75")]
        seen = record_at_terminal(target, folder / "run.csv", *first, *later, seconds=7)
    assert " 0 dropped, 0 damaged frames" in seen
    return folder / "run.csv"


@pytest.fixture
def text(recorded: Path) -> Text:
    return Text(recorded)


# Bit for bit


def test_a_running_program_is_replayed_bit_for_bit(recorded: Path, programs: Path, text: Text) -> None:
    done = epg("replay", recorded, programs / "jiwy_host")
    assert done.returncode == 0, done.stdout + done.stderr
    rows = [row for row in text.rows if row[1] != "0"]
    assert len(rows) > 3000
    count = str(len(rows))
    for name in text.names:
        if name.startswith("outputs."):
            assert cells(done.stdout, name) == [name, count, "0", "-", "-"]
    assert f"{count} control cycles, 1 enabling, 3 changes of parameters\n" in done.stdout
    assert done.stdout.endswith("tolerance: none, because the model has only + - * /\nequal to the bit\n")
    duties = {row[text.names.index("outputs.pwm_pan")] for row in rows}
    assert len(duties) > 100, "the controller works"


def test_changes_of_parameters_are_recorded_in_their_cycle(text: Text) -> None:
    changes = {int(row[1]): row[-1] for row in text.rows if row[-1]}
    assert changes.pop(1) == f"{KP}=2.5"
    ((cycle, both),) = changes.items()
    assert cycle > 1
    assert sorted(both.split(" ")) == [f"{KP}=2.25", "Tilt\\PID\\kp=1.75"]


def test_a_recorded_change_matters(text: Text, programs: Path, tmp_path: Path) -> None:
    text.change(1, "changes", "")
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / "jiwy_host")
    assert done.returncode == 5
    assert cells(done.stdout, "outputs.pwm_pan")[2] != "0"
    assert cells(done.stdout, "outputs.pwm_tilt")[2] == "0"
    assert done.stdout.endswith("DIFFERENT\n")


def test_one_bit_of_an_output_is_noticed_in_its_cycle(text: Text, programs: Path, tmp_path: Path) -> None:
    value = float(text.cell(777, "outputs.pwm_tilt"))
    (bits,) = struct.unpack("<Q", struct.pack("<d", value))
    (other,) = struct.unpack("<d", struct.pack("<Q", bits ^ 1))
    text.change(777, "outputs.pwm_tilt", repr(other))
    time = float(text.cell(777, "time"))
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / "jiwy_host")
    assert done.returncode == 5
    expected = ["1", f"{abs(other - value):.3g}", f"cycle 777, {time:.6g} s"]
    assert cells(done.stdout, "outputs.pwm_tilt")[2:] == expected
    assert cells(done.stdout, "outputs.pwm_pan")[2] == "0"


def test_another_input_is_noticed_in_its_cycle(text: Text, programs: Path, tmp_path: Path) -> None:
    text.change(3000, "inputs.position_pan", repr(math.nextafter(float(text.cell(3000, "inputs.position_pan")), 9.0)))
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / "jiwy_host", "--json")
    assert done.returncode == 5
    found = json.loads(done.stdout)
    assert not found["passed"]
    firsts = [output["first"]["cycle"] for output in found["outputs"] if output["first"]]
    assert firsts
    assert min(firsts) == 3000


def test_each_enabling_is_replayed_by_itself(programs: Path, tmp_path: Path) -> None:
    with running(programs / "jiwy_host", tmp_path) as target:
        lines = ["enable", f"set {KP}=2.5", "disable", f"set {KP}=2.25", "enable", "tilt_subscriber=0.2"]
        record(target, tmp_path / "run.csv", *lines, seconds=1)
    done = epg("replay", tmp_path / "run.csv", programs / "jiwy_host")
    assert done.returncode == 0, done.stdout + done.stderr
    assert ", 2 enablings, 2 changes of parameters\n" in done.stdout


def test_a_recording_that_begins_too_late_is_replayed_from_the_next_enabling(programs: Path, tmp_path: Path) -> None:
    with running(programs / "jiwy_host", tmp_path) as target:
        epg("live", target.port, "--signals", "none", "--send", "disable")
        started = record(target, tmp_path / "first.csv", "enable", seconds=0.3)
        assert "already" not in started.stderr
    text = Text(tmp_path / "first.csv")
    again = [row.copy() for row in text.rows if row[1] != "0"]
    text.rows = again[20:] + [[*row[:1], "0", *row[2:]] for row in again[:3]] + again
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / "jiwy_host")
    assert done.returncode == 0, done.stdout + done.stderr
    assert f"{len(again)} control cycles, 1 enabling" in done.stdout
    message = f"the recording begins while the target is enabled: its first {len(again) - 20} cycles are not replayed"
    assert done.stderr == f"{tmp_path / 'run.csv'}:3: note: {message} [replay-begin]\n"


def test_other_parameters_and_a_trace(recorded: Path, programs: Path, text: Text, tmp_path: Path) -> None:
    arguments = ["replay", recorded, programs / "jiwy_host", "--set", f"{KP}=2.25", "--trace", tmp_path / "trace.csv"]
    done = epg(*arguments)
    assert done.returncode == 5
    assert cells(done.stdout, "outputs.pwm_tilt")[2] == "0"
    assert cells(done.stdout, "outputs.pwm_pan")[2] != "0"
    header, *rows = (tmp_path / "trace.csv").read_text().splitlines()
    assert len(rows) == sum(row[1] != "0" for row in text.rows)
    position = header.split(",").index("inputs.position_pan")
    at = text.index(500)
    assert float(rows[499].split(",")[position]) == float(text.rows[at][text.names.index("inputs.position_pan")])
    again = epg(*arguments)
    assert again.returncode == 1
    assert "this file exists [file-exists]" in again.stderr


def test_a_cut_off_row_is_left_out(recorded: Path, programs: Path, tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text(recorded.read_text()[:-15])
    done = epg("replay", tmp_path / "run.csv", programs / "jiwy_host")
    assert done.returncode == 0, done.stdout + done.stderr
    done = epg("replay", recorded, programs / "jiwy_host", "--json")
    assert json.loads(done.stdout)["cycles"] == sum(row[1] != "0" for row in Text(recorded).rows)


def test_the_trace_of_a_host_program_is_replayed(programs: Path, tmp_path: Path) -> None:
    setpoints = tmp_path / "setpoints.csv"
    setpoints.write_text("time,topic,value\n0.2,$enable,1\n0.5,wanted,1.5\n1.5,$enable,0\n1.6,$enable,1\n")
    command = [
        programs / "filter_host",
        "--duration=2",
        f"--setpoints={setpoints}",
        f"--trace={tmp_path / 'trace.csv'}",
    ]
    from tests.runtime.program import run_program

    assert run_program(command).returncode == 0
    done = epg("replay", tmp_path / "trace.csv", programs / "filter_host")
    assert done.returncode == 0, done.stdout + done.stderr
    assert "1700 control cycles, 2 enablings, 0 changes of parameters\n" in done.stdout
    assert done.stdout.endswith("equal to the bit\n")


def test_the_example_of_the_page(programs: Path, tmp_path: Path) -> None:
    page = (ROOT / "docs/replay.md").read_text()
    commands, output = re.findall(r"^```(?:sh)?\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)[:2]
    start, *lines = commands.splitlines()
    assert start.split()[:2] == ["build/jiwy/jiwy_host", "--realtime"]
    with running(programs / "jiwy_host", tmp_path) as target:
        for line in lines:
            words = [
                str({"/tmp/jiwy": target.port, "build/jiwy/jiwy_host": programs / "jiwy_host"}.get(word, word))
                for word in shlex.split(line)
            ]
            assert words[0] == "epg"
            done = epg(*words[1:], cwd=tmp_path)
            assert done.returncode == 0, done.stdout + done.stderr
    expected = ".*".join(re.escape(part) for part in output.split("..."))
    assert re.fullmatch(expected, re.sub(r"(?<=\d) +0 ", "     0 ", done.stdout)), done.stdout


# Functions of the C library


def test_another_c_library_stays_within_the_tolerance(programs: Path, tmp_path: Path) -> None:
    with running(programs / "other_host", tmp_path) as target:
        record(target, tmp_path / "run.csv", "wanted=0.5", "enable", "wanted=4", "set damping=0.25", seconds=3)
    own = epg("replay", tmp_path / "run.csv", programs / "other_host")
    assert own.returncode == 0, own.stdout + own.stderr
    assert own.stdout.endswith("equal to the bit\n")
    done = epg("replay", tmp_path / "run.csv", programs / "pendulum_host")
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(cells(done.stdout, "outputs.angle")[2]) > 500
    assert 0.0 < float(cells(done.stdout, "outputs.angle")[3]) < 1e-12
    assert cells(done.stdout, "outputs.time")[2] == "0"
    tolerance = "tolerance: 1e-09 of each output's largest value, because the model calls sin\n"
    assert done.stdout.endswith(f"{tolerance}equal within the tolerance\n")
    exact = epg("replay", tmp_path / "run.csv", programs / "pendulum_host", "--tolerance", "0")
    assert exact.returncode == 5
    text = Text(tmp_path / "run.csv")
    angle = text.cell(900, "outputs.angle")
    text.change(900, "outputs.angle", repr(float(angle) + 1e-6))
    wrong = epg("replay", text.write(tmp_path / "wrong.csv"), programs / "pendulum_host")
    assert wrong.returncode == 5
    assert cells(wrong.stdout, "outputs.angle")[3] == "1e-06"


# Refused


def refused(text: Text, programs: Path, tmp_path: Path, program: str = "jiwy_host") -> str:
    """The first line of the message about a changed recording, and its hint."""
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / program, cwd=tmp_path)
    assert done.returncode == 1, done.stdout
    assert "Traceback" not in done.stderr
    return done.stderr.replace(str(tmp_path) + "/", "")


def test_a_gap(text: Text, programs: Path, tmp_path: Path) -> None:
    at = text.index(100)
    del text.rows[at : at + 5]
    time = float(text.rows[at - 1][0])
    assert refused(text, programs, tmp_path) == (
        f"run.csv:{at + 3}: error: 5 control cycles are missing after {time:.6g} s [replay-gap]\n"
        "hint: rows were dropped: a larger 'capture' in 'communication' of the .tcf keeps more rows in memory\n"
    )


def test_another_model(text: Text, programs: Path, tmp_path: Path) -> None:
    assert "error: the recording is of another model or of other generated parameters" in refused(
        text, programs, tmp_path, "filter_host"
    )


def test_an_enabling_that_was_missed(text: Text, programs: Path, tmp_path: Path) -> None:
    text.rows = text.rows[text.index(50) :]
    assert refused(text, programs, tmp_path) == (
        "run.csv:3: error: the recording begins while the target is enabled: the state of the model is not known "
        "[replay-begin]\nhint: disable the target, then record: epg live PORT --record FILE --send enable\n"
    )


def test_a_value_that_is_not_finite(text: Text, programs: Path, tmp_path: Path) -> None:
    text.change(50, "inputs.position_tilt", "nan")
    line = text.line_of(50)
    assert f"run.csv:{line}: error: 'inputs.position_tilt' is nan in an enabled cycle" in refused(
        text, programs, tmp_path
    )


def test_a_parameter_that_does_not_exist(text: Text, programs: Path, tmp_path: Path) -> None:
    text.change(50, "changes", "nonsense=2.0")
    assert "this program has no parameter 'nonsense' that can be changed" in refused(text, programs, tmp_path)
    done = epg("replay", text.write(tmp_path / "run.csv"), programs / "jiwy_host", "--set", "Pan\\PID\\ki=1")
    assert done.returncode == 1
    assert "has no parameter 'Pan\\PID\\ki' that can be changed [unknown-parameter]" in done.stderr


def test_a_program_refuses_wrong_recordings_by_itself(text: Text, programs: Path, tmp_path: Path) -> None:
    from tests.runtime.program import run_program

    def said(path: Path, *options: str) -> str:
        done = run_program([programs / "jiwy_host", f"--replay={path}", *options])
        assert done.returncode == 2
        return done.stderr.replace(str(tmp_path) + "/", "")

    path = text.write(tmp_path / "run.csv")
    assert said(path, "--duration=1").startswith("error: --replay with another option than --trace and --quiet\n")
    assert said(tmp_path / "none.csv") == "none.csv: error: cannot read this file: No such file or directory\n"
    (tmp_path / "other.csv").write_text("time,cycle\n0,1\n")
    assert said(tmp_path / "other.csv") == "other.csv:1: error: this file is not a recording of 'epg live --record'\n"
    done = run_program([programs / "jiwy_host", f"--replay={path}"])
    assert done.stdout == f"jiwy: {sum(row[1] != '0' for row in text.rows)} cycles replayed\n"
    text.change(60, "inputs.setpoint_pan", "x")
    assert said(text.write(path)) == f"run.csv:{text.line_of(60)}: error: 'x' is not a number\n"
    text.change(60, "inputs.setpoint_pan", "0")
    del text.rows[text.index(50)]
    assert said(text.write(path)) == f"run.csv:{text.line_of(51)}: error: cycle 51 must not follow cycle 49\n"
    text.names[2] = "inputs.other"
    assert said(text.write(path)) == "run.csv:2: error: the column 'inputs.position_pan' is missing\n"
    path.write_bytes(b"# epg recording 1 {}\n" + b"x" * 100_000)
    assert said(path) == "run.csv:2: error: this line is too long\n"


@pytest.mark.parametrize(
    ("ports", "extra", "text"),
    [
        (28, 5, "its model has 28 ports, and a recording for a replay has at most 27"),
        (4, 0, "its firmware was made by an EPG without replays: build it again"),
    ],
)
def test_a_target_that_cannot_be_recorded(ports: int, extra: int, text: str) -> None:
    signals = tuple(StreamedSignal(f"inputs.{number}", "") for number in range(ports))
    replay = tuple(StreamedSignal(f"replay.{number}", "") for number in range(extra))
    found = TargetDescription("a", "a", "1", "2", "3", 0.001, (), (), signals, (), replay, (), (), (), (), ())
    with pytest.raises(CommandRefused, match=re.escape(text)):
        signals_to_record(found)
