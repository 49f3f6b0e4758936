# SPDX-License-Identifier: Apache-2.0
"""JIWY in closed loop on the emulated STM32H743: the host's bits in every cycle, and levels that act at one instant."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

from epg.runs.executable import run_executable
from epg.runs.recording import read_table
from tests.platforms.stm32.images import PLATFORMS, host
from tests.platforms.stm32.jiwy import AXES, SIGNALS, Jiwy

HOMED = 900
"""Cycles after which both axes have homed and stand still."""
LATEST = 3
"""Cycles within which a setpoint arrives: 0.5 ms on the line, a turn of the service, and the tick after it."""
FLOODED = 200
"""Cycles."""
GARBAGE = b"get \xff\x00 pan_subscriber=\n=\n"
DUTIES = tuple(f"plant.inputs.duty_{axis}" for axis in AXES)


def simulated(jiwy: Jiwy, folder: Path) -> dict[str, list[float]]:
    """The host with its own robot; its setpoints come in the same cycles as those of the image."""
    lines = ["time,topic,value\n"]
    before = dict.fromkeys(AXES, 0.0)
    for number, row in enumerate(jiwy.rows):
        for axis in AXES:
            value = row[f"inputs.setpoint_{axis}"]
            if value != before[axis]:
                lines.append(f"{number / 1000:.3f},{axis}_subscriber,{value!r}\n")
                before[axis] = value
    setpoints = folder / "setpoints.csv"
    setpoints.write_text("".join(lines), encoding="utf-8")
    run_executable(
        host() / "jiwy_host", folder, len(jiwy.rows) / 1000, setpoints, realtime=False, progress=lambda message: None
    )  # fmt: skip
    trace = read_table(folder / "trace.csv", {*SIGNALS, *DUTIES}.__contains__).signals
    return {name: list(signal.value) for name, signal in trace.items()}


@pytest.mark.parametrize("platform", PLATFORMS)
def test_every_bit_is_the_hosts(platform: str, tmp_path: Path) -> None:
    """Homing, then setpoints over the console: ports of the model and duties at the motors are equal in every cycle."""
    jiwy = Jiwy(platform)
    jiwy.run(HOMED)
    for number in range(15):
        pan, tilt = 0.2 * (number % 5), 0.4 - 0.02 * number
        jiwy.line.send(f"pan_subscriber={pan!r} tilt_subscriber={tilt!r}\r\n".encode())
        jiwy.run(LATEST)
        row = jiwy.rows[-1]
        assert (row["inputs.setpoint_pan"], row["inputs.setpoint_tilt"]) == (pan, tilt)
        jiwy.run(50 - LATEST)
    expected = simulated(jiwy, tmp_path)
    assert len(expected[SIGNALS[0]]) == len(jiwy.rows) >= 1400
    for number, row in enumerate(jiwy.rows):
        assert row == {name: expected[name][number] for name in SIGNALS}, f"cycle {number}"
        assert jiwy.duties[number] == tuple(expected[name][number] for name in DUTIES), f"cycle {number}"
    for axis in AXES:
        assert max(row[f"outputs.encoder_reset_{axis}"] for row in jiwy.rows) == 1.0, "homing has ended"
        assert len({row[f"outputs.pwm_{axis}"] for row in jiwy.rows}) > 300, "there was something to compare"
    for counts in zip(*jiwy.counts, strict=True):
        assert min(counts) < 0 < max(counts), "the decoder's counter of 16 bits has wrapped both ways"
    stats = jiwy.stats()
    assert {stats[name] for name in ("missed", "overruns", "faults", "clamped", "lines_dropped")} == {"0"}
    assert jiwy.chip.dma.errors == jiwy.chip.cache.hazards == jiwy.chip.resets == []


@pytest.mark.parametrize("platform", PLATFORMS)
def test_levels_act_at_the_same_update_event_while_bytes_come_without_pause(platform: str) -> None:
    """Both channels, in every cycle, counted from the tick; the console gets setpoints and garbage."""
    jiwy = Jiwy(platform)
    jiwy.run(HOMED)
    before = len(jiwy.chip.levels)
    for number in range(FLOODED):
        while len(jiwy.line.sent) < 200:
            setpoint = 0.3 + 0.2 * math.sin(number / 20)
            jiwy.line.send(b"pan_subscriber=%.9f tilt_subscriber=%.9f\n" % (setpoint, setpoint) + GARBAGE)
        jiwy.run(1)
    jiwy.assert_levels_act_together(before, changes=round(0.8 * FLOODED))
    assert jiwy.chip.interrupts(jiwy.timer.kind.update) == jiwy.ticks
    jiwy.line.sent.clear()
    jiwy.line.send(b"\n")
    jiwy.run(100)
    stats = jiwy.stats()
    assert {stats[name] for name in ("missed", "overruns", "faults", "outputs_late", "clamped")} == {"0"}
    assert jiwy.chip.dma.errors == jiwy.chip.cache.hazards == jiwy.chip.resets == []
