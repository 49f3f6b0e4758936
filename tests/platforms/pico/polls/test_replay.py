# SPDX-License-Identifier: Apache-2.0
"""An RP2040 is recorded over USB, and its host program computes the same outputs from the same inputs, bit for bit."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from tests.emulator.emulator import Emulator
from tests.middlewares.conftest import build_jiwy
from tests.platforms.pico.images import images, skip_unless_emulated

from .measure import CONSOLE, _polls, _started
from .test_live import ROOT, STEP, terminal

SECONDS = 8
"""Duration of the recording by this computer's clock.  The board's time is slower."""


def test_a_board_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    skip_unless_emulated("bare_metal")
    host = build_jiwy(tmp_path / "build", "undefined")
    elf = images("pico", "bare_metal", "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    with _started(elf, 3) as pico:
        pico.call("usb_open", port=CONSOLE)
        pico.run(milliseconds=STEP)
        record(pico, tmp_path / "run.csv")
        assert _polls(pico, "a recording").deviations == {0}
    done = epg("replay", tmp_path / "run.csv", host)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "equal to the bit" in done.stdout
    rows = (tmp_path / "run.csv").read_text().splitlines()[2:]
    cycles = [int(row.split(",")[1]) for row in rows]
    assert max(cycles) > 300
    told = [row for row in rows if "=" in row]
    assert told[0].split(",")[1] == "1", "a change before the enabling acts in its cycle"
    assert "kp=2.5" in told[0]
    assert any("kp=2.25" in row for row in told[1:])
    duties = {row.split(",")[10] for row in rows}
    assert len(duties) > 20, "the motor is driven"


def record(pico: Emulator, path: Path) -> None:
    sent = ["disable", r"set Pan\PID\kp=2.5", "enable", "pan_subscriber=0.4 tilt_subscriber=0.3", r"set Pan\PID\kp=2.25"]
    with terminal(pico) as port:
        lines = [word for line in sent for word in ("--send", line)]
        done = epg("live", port, "--record", path, *lines, "--duration", str(SECONDS))
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 dropped, 0 damaged frames" in done.stdout


def epg(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "epg", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=120, check=False)
