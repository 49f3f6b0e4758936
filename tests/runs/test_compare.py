# SPDX-License-Identifier: Apache-2.0
"""``epg plot`` finds known shifts, lags and differences in recordings."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable
from pathlib import Path

import pytest

from epg.cli.main import main
from epg.generator import bootstrap
from epg.generator.diagnostics import Diagnostics
from epg.runs.recording import read_recording

bootstrap.ensure("plot")
from matplotlib import image  # noqa: E402  # only after the check that it can be imported

Motion = Callable[[float], float]


def move(t: float) -> float:
    """At rest until 2 s, to 1 until 4 s, down to -0.5 until 7 s, at rest; all parts differ."""
    if t < 4.0:
        s = min(max((t - 2.0) / 2.0, 0.0), 1.0)
        return 0.5 - 0.5 * math.cos(math.pi * s)
    s = min(max((t - 5.0) / 2.0, 0.0), 1.0)
    return 1.0 - 0.75 * (1.0 - math.cos(math.pi * s))


def write(path: Path, signals: dict[str, Motion], begin: float, end: float, step: float, clock: float = 0.0) -> Path:
    """A recording from ``begin`` to ``end`` of a clock that shows ``clock`` at the motion's time 0."""
    path.parent.mkdir(parents=True, exist_ok=True)
    count = round((end - begin) / step)
    times = [begin + step * i for i in range(count)]
    text = [f"{t:.6f},{name},{motion(t - clock)!r}\n" for t in times for name, motion in signals.items()]
    path.write_text("time,topic,value\n" + "".join(text), encoding="utf-8")
    return path


def compare(capsys: pytest.CaptureFixture[str], *options: str | Path) -> dict[str, float | dict[str, dict[str, float]]]:
    assert main(["plot", *map(str, options), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    return {"shift": found["shift"], **{signal["signal"]: signal for signal in found["signals"]}}


@pytest.fixture(autouse=True)
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("align", ["correlation", "motion"])
@pytest.mark.parametrize("clock", [-1.2345, 0.0, 40.0])
def test_another_clock(align: str, clock: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = write(tmp_path / "run.csv", {"pan": move}, 1.0 + clock, 8.0 + clock, 0.033, clock)
    sim = write(tmp_path / "sim.csv", {"pan": move}, 0.0, 9.0, 0.001)
    found = compare(capsys, run, "--against", sim, "--align", align)
    # the first motion is detected at the next sample of the run
    assert found["shift"] == pytest.approx(-clock, abs=0.034 if align == "motion" else 0.0005)
    assert found["pan"]["rms"] < (0.03 if align == "motion" else 0.001)
    assert abs(found["pan"]["lag"]) < (0.034 if align == "motion" else 0.001)


def test_setpoints_align_so_that_the_lag_of_a_position_is_seen(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    noise = random.Random(1)
    late = {"pan": lambda t: move(t - 0.066) + 0.01 * noise.gauss(0.0, 1.0), "tilt": lambda t: 2.0 * move(t)}
    for name, positions, clock in (("run", late, 3.0), ("sim", {"pan": move, "tilt": lambda t: 2.0 * move(t)}, 0.0)):
        write(tmp_path / name / "setpoints.csv", {"command": move}, clock, 9.0 + clock, 0.033, clock)
        write(tmp_path / name / "topics.csv", positions, 0.011 + clock, 9.0 + clock, 0.033, clock)
    found = compare(capsys, tmp_path / "run", "--against", tmp_path / "sim")
    assert found["shift"] == pytest.approx(-3.0, abs=1e-4)
    assert found["pan"]["lag"] == pytest.approx(0.066, abs=0.005)  # despite the noise
    assert found["tilt"]["lag"] == pytest.approx(0.0, abs=0.002)
    assert found["pan"]["rms_without_lag"] == pytest.approx(0.01, rel=0.25)
    assert found["pan"]["rms"] > 3 * found["pan"]["rms_without_lag"]
    # without setpoints, the positions are compared, and the lag is divided between them
    for name in ("run", "sim"):
        (tmp_path / name / "setpoints.csv").unlink()
    found = compare(capsys, tmp_path / "run", "--against", tmp_path / "sim")
    assert found["shift"] == pytest.approx(-3.033, abs=0.02)
    found = compare(capsys, tmp_path / "run", "--against", tmp_path / "sim", "--by", "tilt")
    assert found["shift"] == pytest.approx(-3.0, abs=0.002)


def test_numbers_of_a_difference(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = write(tmp_path / "run.csv", {"a": lambda t: move(t) + 0.1, "b": lambda t: 1.0}, 0.0, 9.0, 0.01)
    sim = write(tmp_path / "sim.csv", {"a": move, "b": lambda t: 1.0}, 0.0, 9.0, 0.01)
    found = compare(capsys, run, "--against", sim, "--align", "none")
    assert found["shift"] == 0.0
    assert found["a"]["rms"] == pytest.approx(0.1)
    assert found["a"]["largest"] == pytest.approx(0.1)
    assert found["b"] == {"signal": "b", "against": "b", "rms": 0, "largest": 0, "lag": 0, "rms_without_lag": 0}


def test_a_part_of_a_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Homing differs each time and is excluded; the whole run is still aligned."""
    run = write(tmp_path / "run.csv", {"a": lambda t: move(t) + (5.0 if t < 1.0 else 0.0)}, 0.0, 9.0, 0.01)
    sim = write(tmp_path / "sim.csv", {"a": move}, 0.0, 9.0, 0.01)
    assert compare(capsys, run, "--against", sim, "--align", "none")["a"]["largest"] == pytest.approx(5.0)
    part = compare(capsys, run, "--against", sim, "--align", "none", "--from", "1.1", "--until", "8")
    assert part["a"]["largest"] < 1e-9


def test_signals_of_other_names_and_a_trace(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = write(tmp_path / "run.csv", {"pan_publisher": move}, 0.0, 9.0, 0.033)
    trace = tmp_path / "trace.csv"
    lines = [f"{t / 1000},{0.0},{move(t / 1000)!r},1\n" for t in range(9000)]
    trace.write_text("time,inputs.x,plant.outputs.angle_pan,enabled\n" + "".join(lines), encoding="utf-8")
    found = compare(capsys, run, "--against", trace, "--signal", "pan_publisher=plant.outputs.angle_pan")
    assert found["shift"] == pytest.approx(0.0, abs=0.0005)
    assert found["pan_publisher"]["against"] == "plant.outputs.angle_pan"


def test_the_picture_shows_both(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    run = write(tmp_path / "run.csv", {"pan": lambda t: move(t) + 0.3}, 0.0, 9.0, 0.033)
    sim = write(tmp_path / "sim.csv", {"pan": move}, 0.0, 9.0, 0.033)
    assert main(["plot", str(run), "--against", str(sim), "--align", "none", "--output", "both.png"]) == 0
    assert "wrote both.png" in capsys.readouterr().out
    picture = image.imread(tmp_path / "both.png")[:, :, :3].reshape(-1, 3)
    for colour in ((0x00, 0x72, 0xB2), (0xD5, 0x5E, 0x00)):
        distance = abs(picture * 255.0 - colour).sum(axis=1)
        assert (distance < 6.0).sum() > 500, colour

    assert main(["plot", str(run)]) == 0
    assert (tmp_path / "run.png").stat().st_size > 5000


def test_what_simulate_and_record_leave_is_read(tmp_path: Path) -> None:
    problems = Diagnostics()
    write(tmp_path / "topics.csv", {"pan": move}, 0.0, 1.0, 0.1)
    (tmp_path / "setpoints.csv").write_text("time,topic,value\n0,command,1\n\n0.5,$enable,0\n0.6,command,nan\n")
    recording = read_recording(tmp_path, problems)
    assert recording is not None and not problems.items
    assert sorted(recording.signals) == ["command", "pan"]
    assert recording.setpoints == {"command"}
    assert list(recording.signals["command"].value) == [1.0]
    assert len(recording.signals["pan"].time) == 10


def test_the_last_line_of_a_killed_run_is_left_out(tmp_path: Path) -> None:
    file = tmp_path / "trace.csv"
    file.write_text("time,angle\n0,1.5\n0.001,2.5\n0.002,1.", encoding="ascii")
    recording = read_recording(file, Diagnostics())
    assert recording is not None and list(recording.signals["angle"].value) == [1.5, 2.5]


def test_a_long_recording_keeps_its_peaks_and_the_times_of_its_states(tmp_path: Path) -> None:
    def row(at: int) -> str:
        return f"{at / 1000:.3f},{at % 7 - 1000 * (at == 12_345)},{int(at >= 30_001)}\n"

    file = tmp_path / "trace.csv"
    file.write_text("time,angle,enabled\n" + "".join(map(row, range(50_000))), encoding="ascii")
    recording = read_recording(file, Diagnostics(), most=1000)
    assert recording is not None
    angle, enabled = recording.signals["angle"], recording.signals["enabled"]
    assert 100 < len(angle.time) <= 1000
    assert (min(angle.value), max(angle.value)) == (12_345 % 7 - 1000, 6)
    assert list(angle.time) == sorted(angle.time)
    assert next(time for time, value in zip(enabled.time, enabled.value) if value) == 30.001
