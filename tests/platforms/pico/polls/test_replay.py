# SPDX-License-Identifier: Apache-2.0
"""An RP2040 is recorded over USB, and its host program computes the same outputs from the same inputs, bit for bit."""

from __future__ import annotations

from pathlib import Path

from tests.doubles.rp2040.emulator import Emulator
from tests.live.replays import Text, build_programs, cells, epg
from tests.platforms.pico.images import images, skip_unless_emulated

from .measure import CONSOLE, _polls, _started
from .test_live import STEP, terminal

SECONDS = 10
"""Duration of the recording by this computer's clock.  The board's time is slower."""
HOMING = " ".join(
    f"{axis}\\Homing\\{name}={value}"
    for axis in ("Pan", "Tilt")
    for name, value in (("standstill", 0.003), ("margin", -1), ("pulse", 0.05), ("settle", 0.05))
)
"""Values with which the axes stay where they are, and are controlled 0.1 s after the enabling."""
SENT = (
    "disable",
    f"set {HOMING}",
    "pan_subscriber=0.4 tilt_subscriber=0.3",
    "enable",
    "stats",  # the control cycles of its answer lie between the changes
    "set Pan\\Homing\\margin=1 Tilt\\Homing\\margin=1 Pan\\PID\\kp=2.5",
)


def test_a_board_is_replayed_bit_for_bit(tmp_path: Path) -> None:
    skip_unless_emulated("bare_metal")
    host = build_programs(tmp_path / "build", "jiwy_host") / "jiwy_host"
    elf = images("pico", "bare_metal", "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    with _started(elf, 3) as pico:
        pico.call("usb_open", port=CONSOLE)
        pico.run(milliseconds=STEP)
        record(pico, tmp_path / "run.csv")
        assert _polls(pico, "a recording").deviations == {0}
    done = epg("replay", tmp_path / "run.csv", host)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.endswith("equal to the bit\n")
    text = Text(tmp_path / "run.csv")
    told = [row for row in text.rows if row[-1]]
    assert [len(row[-1].split(" ")) for row in told] == [8, 3]
    assert told[0][1] == "1", "the changes before the enabling act in its cycle"
    duties = {row[text.names.index("outputs.pwm_pan")] for row in text.rows}
    assert len(duties) > 50, "the controller works"
    assert int(cells(done.stdout, "outputs.pwm_pan")[1]) > 150


def record(pico: Emulator, path: Path) -> None:
    with terminal(pico) as port:
        lines = [word for line in SENT for word in ("--send", line)]
        done = epg("live", port, "--record", path, *lines, "--duration", str(SECONDS))
    assert done.returncode == 0, done.stdout + done.stderr
    assert " 0 dropped, 0 damaged frames" in done.stdout
