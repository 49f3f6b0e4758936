# SPDX-License-Identifier: Apache-2.0
"""The console of a real executable: JIWY with its simulated plant, in real time."""

from __future__ import annotations

import contextlib
import csv
import os
import random
import signal
import stat as stat_module
import struct
import subprocess
import termios
import time
import zlib
from pathlib import Path

import pytest

from tests.waiting import until

from .client import Host, Lines, stat, values

MODEL = 140
"""Offset of the model's name in a store: targets/runtime/src/communication/store.c."""


def test_values_of_a_watch_line_are_of_one_cycle(jiwy_host: Path) -> None:
    with Host(jiwy_host) as console:
        console.ask("watch setpoint_pan setpoint_tilt")
        lines: list[str] = []
        for number in range(500):
            value = number / 700 + 0.5
            console.send(f"pan_subscriber={value!r} tilt_subscriber={value!r}\n")
            lines += console.receive(0.002)
        seen = {tuple(values(line).values()) for line in lines if line.startswith("watch ")}
        assert len(seen) > 5
        assert all(pan == tilt for pan, tilt in seen)
        times = [float(line.split()[1]) for line in lines if line.startswith("watch ")]
        assert times == sorted(set(times))


def test_parameters_are_set_saved_and_back_after_a_restart(jiwy_host: Path, tmp_path: Path) -> None:
    store = tmp_path / "store"
    with Host(jiwy_host, "--store", str(store)) as console:
        assert console.ask("get Pan\\PID\\kp") == ["parameter Pan\\PID\\kp=2.6", "ok get"]
        assert console.ask("set Pan\\PID\\kp=0.1 Tilt\\PID\\tauI=12") == ["ok set"]
        assert console.ask("set Pan\\PID\\kp=nan")[-1] == "error set this is not a number: 'nan'"
        assert console.ask("save")[-1].startswith("error save")
        assert console.ask("disable")[-1] == "ok disable"
        assert console.ask("save") == ["ok save values=2"]
        assert "stored=saved" in console.ask("version")[-1]
        assert console.close() == (0, "")
    with Host(jiwy_host, "--store", str(store)) as console:
        assert console.ask("get Pan\\PID\\kp") == ["parameter Pan\\PID\\kp=0.1 generated=2.6", "ok get"]
        assert "stored=loaded" in console.ask("version")[-1]
    data = bytearray(store.read_bytes())
    data[MODEL] ^= 1  # as if another model had saved these data
    store.write_bytes(data)
    with Host(jiwy_host, "--store", str(store)) as console:
        assert console.ask("get Pan\\PID\\kp") == ["parameter Pan\\PID\\kp=2.6", "ok get"]
        assert "stored=of_another_model" in console.ask("version")[-1]
    with Host(jiwy_host) as console:
        console.ask("disable")
        assert console.ask("save") == ["error save this program was started without --store FILE"]


def with_value(value: float, store: Path) -> bytes:
    """The bytes of ``store`` with another value of the one parameter in it, as if its limits had been wider."""
    data = bytearray(store.read_bytes())
    data[-12:-4] = struct.pack("<d", value)
    data[-4:] = struct.pack("<I", zlib.crc32(data[:-4]))
    return bytes(data)


def save(program: Path, store: str | Path) -> str:
    """The answer to ``save`` of a parameter that has changed."""
    with Host(program, "--store", str(store)) as console:
        console.ask("set Pan\\PID\\kp=0.1")
        console.ask("disable")
        return console.ask("save")[-1]


def test_a_store_that_cannot_be_written_says_why(jiwy_host: Path, tmp_path: Path) -> None:
    cannot = "error save the file of --store cannot be written: "
    assert save(jiwy_host, tmp_path / "none" / "store") == f"{cannot}No such file or directory"
    folder = tmp_path / "folder"
    folder.mkdir()
    assert save(jiwy_host, folder) == "error save the path of --store is not a file, but a folder or a device"
    device = tmp_path / "null"
    if os.geteuid() == 0:
        os.mknod(device, stat_module.S_IFCHR | 0o666, os.makedev(1, 3))
        assert save(jiwy_host, device) == "error save the path of --store is not a file, but a folder or a device"
        assert stat_module.S_ISCHR(device.stat().st_mode)


@pytest.mark.skipif(os.geteuid() != 0, reason="needs root, to mount a small file system")
def test_a_full_disk_keeps_the_old_store(jiwy_host: Path, tmp_path: Path) -> None:
    disk = tmp_path / "disk"
    disk.mkdir()
    if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=8k", "tmpfs", str(disk)], check=False).returncode != 0:
        pytest.skip("a file system cannot be mounted here")
    try:
        (disk / "store").write_bytes(b"old")
        with contextlib.suppress(OSError), (disk / "filler").open("wb", buffering=0) as filler:
            while True:
                filler.write(bytes(1024))
        answer = save(jiwy_host, disk / "store")
        assert answer == "error save the file of --store cannot be written: No space left on device"
        assert (disk / "store").read_bytes() == b"old" and not (disk / "store.new").exists()
    finally:
        subprocess.run(["umount", str(disk)], check=True)


def test_a_link_to_the_store_stays_a_link(jiwy_host: Path, tmp_path: Path) -> None:
    real, link = tmp_path / "real", tmp_path / "link"
    real.touch(mode=0o640)
    link.symlink_to(real)
    assert save(jiwy_host, link) == "ok save values=1"
    assert link.is_symlink() and real.stat().st_size > 0 and stat_module.S_IMODE(real.stat().st_mode) == 0o640
    link.unlink()
    link.symlink_to(tmp_path / "gone")
    assert save(jiwy_host, link).endswith("No such file or directory")


def test_the_state_of_the_store_is_told_at_the_start_and_by_version(jiwy_host: Path, tmp_path: Path) -> None:
    store = tmp_path / "store"
    assert save(jiwy_host, store) == "ok save values=1"
    whole = store.read_bytes()
    replaced = "all have their generated values, and 'save' replaces the file"
    data = with_value(float("inf"), store)
    for bytes_, words, told in (
        (whole[:-5], "stored=damaged", f"{store}: warning: the stored parameters are damaged: {replaced}\n"),
        (b"", "stored=nothing", f"{store}: warning: there are no stored parameters in this file: {replaced}\n"),
        (
            data,
            "stored=partly",
            f"{store}: warning: the stored value of Pan\\PID\\kp is outside of its limits: "
            "it has its generated value\n",
        ),
    ):
        store.write_bytes(bytes_)
        with Host(jiwy_host, "--store", str(store)) as console:
            answer = console.ask("version")
            assert words in answer[-1]
            assert answer[:-1] == (["refused Pan\\PID\\kp"] if words == "stored=partly" else [])
            assert console.close() == (0, told)


def cycles_of(console: Host) -> tuple[int, int]:
    """The number of cycles and of missed ticks so far."""
    answer = console.ask("stats")
    return int(stat(answer, "cycles")), int(stat(answer, "missed"))


def passes(console: Host, ticks: int) -> None:
    """Waits until the target has had so many ticks more."""
    end = sum(cycles_of(console)) + ticks
    until(lambda: sum(cycles_of(console)) >= end, pause=0.005)


def test_random_bytes_do_no_harm(jiwy_host: Path) -> None:
    """ASan and UBSan would end the program at an error."""
    chance = random.Random(5)
    words = [
        b"watch",
        b"capture position_pan",
        b"set Pan\\PID\\kp=",
        b"jog pwm_pan 0.1 5",
        b"\n",
        b"get",
        b"=",
        b"read",
    ]
    with Host(jiwy_host) as console:
        for _ in range(300):
            blob = chance.randbytes(chance.randrange(300))
            console.send(blob + b" ".join(chance.choices(words, k=chance.randrange(6))))
            console.receive(0.001)
        console.send(b"\n\x03disable\n")
        console.until("ok disable")
        console.lines.clear()
        assert console.ask("watch off")[-1] == "ok watch"
        assert console.ask("version")[-1].startswith("ok version name=jiwy")
        status, errors = console.close()
        assert (status, errors) == (0, "")


def test_the_loop_keeps_its_cycles_under_a_flood(jiwy_host: Path) -> None:
    """100 kB/s of the worst input for a console: setpoints, questions, garbage."""
    with Host(jiwy_host) as console:
        quiet = cycles_of(console)
        passes(console, 1000)
        before = cycles_of(console)
        block = b"pan_subscriber=0.5 tilt_subscriber=0.25\nstats\nnonsense\x80\n" * 40
        for _ in range(90):
            console.send(block)
            time.sleep(len(block) / 100_000)  # a line of 100 kB/s
            console.receive(0.001)
            console.lines.clear()
        console.send(b"\x03")
        while console.receive(0.3):
            console.lines.clear()
        after = cycles_of(console)
        ticks = sum(after) - sum(before)
        assert ticks > 1900
        idle_share = (before[1] - quiet[1]) / (sum(before) - sum(quiet))
        assert (after[1] - before[1]) / ticks <= idle_share + 0.05


@pytest.fixture
def terminal(jiwy_host: Path, tmp_path: Path) -> Path:
    path = tmp_path / "jiwy"
    process = subprocess.Popen([str(jiwy_host), "--realtime", "--quiet", "--console-pty", str(path)])
    until(path.exists, "the program has no port")
    yield path  # type: ignore[misc]
    process.send_signal(signal.SIGINT)
    assert process.wait(20) == 130
    assert not path.is_symlink()


def test_a_terminal_of_its_own(terminal: Path) -> None:
    """Like a board that a user plugs in, reads, leaves and reads again.  An echo that a user leaves ends."""
    for visit in range(3):
        file = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
        settings = termios.tcgetattr(file)
        settings[3] |= termios.ECHO | termios.ICANON  # macOS sets them when a program opens a terminal
        console = Lines(file, file)
        assert console.until("ready ")[-1].startswith("ready node=JIWY_node epg=")
        assert console.ask("pan_subscriber=0.5") == ["ok setpoint"]
        assert stat(console.ask("stats"), "reconnects") == str(visit)
        assert not termios.tcgetattr(file)[3] & (termios.ECHO | termios.ICANON)
        console.send("watch\n")
        termios.tcsetattr(file, termios.TCSANOW, settings)
        os.close(file)
        time.sleep(0.05)  # the program notices a closed terminal, and cannot tell


def test_a_line_acts_although_the_terminal_is_closed_at_once(terminal: Path) -> None:
    """As by `echo disable > jiwy`; also in two pieces."""
    for pieces in [["disable\n"]] * 20 + [["disa", "ble\n"]]:
        file = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
        console = Lines(file, file)
        console.until("ready ")
        assert console.ask("enable") == ["ok enable"]
        os.close(file)
        for piece in pieces:
            time.sleep(0.02)  # the program notices a closed terminal, and cannot tell
            file = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
            os.write(file, piece.encode())
            os.close(file)
        file = os.open(terminal, os.O_RDWR | os.O_NOCTTY)
        console = Lines(file, file)
        console.until("ready ")
        until(lambda console=console: "stat enabled=0" in console.ask("stats")[0])
        os.close(file)
        time.sleep(0.02)  # the program notices a closed terminal, and cannot tell


def test_a_line_acts_although_nobody_reads_the_answers(jiwy_host: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.csv"
    with Host(jiwy_host, "--duration", "1.5", "--trace", str(trace)) as console:
        assert console.process.stdout is not None
        console.process.stdout.close()
        console.send("version\nversion\n")  # from here on the program knows
        time.sleep(0.2)  # the program has answered, and nobody can read it
        console.send("disable\n")
        assert console.process.wait(20) == 0
    with trace.open(encoding="utf-8", newline="") as file:
        enabled = [row["enabled"] for row in csv.DictReader(file)]
    assert (enabled[0], enabled[-1]) == ("1", "0")


def test_an_old_link_is_replaced_and_a_file_is_not(jiwy_host: Path, tmp_path: Path) -> None:
    link, file = tmp_path / "link", tmp_path / "file"
    link.symlink_to("/dev/pts/gone")
    file.write_text("mine")
    command = [str(jiwy_host), "--realtime", "--quiet", "--duration", "0.1", "--console-pty"]
    assert subprocess.run([*command, str(link)], check=False).returncode == 0
    assert not link.is_symlink()
    done = subprocess.run([*command, str(file)], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "cannot make a terminal with this name: File exists" in done.stderr
    assert file.read_text() == "mine"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--console"], "error: --console without --realtime\nhint: a console needs real time: add --realtime\n"),
        (
            ["--realtime", "--console", "--console-pty", "x"],
            "error: --console and --console-pty\nhint: a target has one console: remove one of the options\n",
        ),
        (
            ["--realtime", "--console", "--trace", "x.csv"],
            "error: --duration is missing\nhint: give the number of seconds, for example --duration 10\n",
        ),
    ],
)
def test_options_that_do_not_go_together(jiwy_host: Path, options: list[str], message: str) -> None:
    done = subprocess.run([str(jiwy_host), *options], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (2, message)


def test_the_input_of_a_script_is_carried_out_to_its_end(jiwy_host: Path) -> None:
    script = "disable\njog pwm_pan 0.1 50\n" + "get Pan\\PID\\kp\n" * 300 + "version\n"
    command = [str(jiwy_host), "--realtime", "--console"]
    done = subprocess.run(command, input=script, capture_output=True, text=True, check=False, timeout=60)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("parameter Pan\\PID\\kp=2.6\n") == 300
    assert "ok jog\n" in done.stdout
    assert "\nok version " in done.stdout
    assert "\r" not in done.stdout


def test_both_sides_race_for_nothing(jiwy_host_for_races: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All data that control and communication side share, with ThreadSanitizer."""
    monkeypatch.setenv("TSAN_OPTIONS", "halt_on_error=1 exitcode=66")
    with Host(jiwy_host_for_races) as console:
        console.ask("watch")
        for number in range(20):
            console.ask(f"set Pan\\PID\\kp={number} Tilt\\PID\\kp={number}")
            console.ask(f"pan_subscriber={number} tilt_subscriber={number}")
            console.ask("capture position_pan pwm_pan rows=50 before=10 when=fault")
            console.ask("capture stop")
            console.ask("disable")
            console.ask("jog pwm_pan 0.1 20")
            console.ask("capture position_pan rows=20")
            console.until("captured state=ready rows=20")
            console.ask("capture read")
            console.ask("stats")
            console.ask("enable")
        assert console.close() == (0, "")
