# SPDX-License-Identifier: Apache-2.0
"""``epg live`` with a real target: JIWY with its simulated plant, in real time."""

from __future__ import annotations

import contextlib
import csv
import json
import os
import pty
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from epg.live.client import Client, CommandRefused, Lost, Rows, Setpoint
from epg.live.port import PortError, SerialPort
from epg.live.rows import Stream
from tests.waiting import read_until, soon, until

from .target import LATE, LEASE, Target, check_every_cycle_has_a_row, client_of, let_pass
from .witness import CYCLE, Robot, build_robot

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def robot_program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The program of a robot whose actuator notes when it was driven."""
    return build_robot(tmp_path_factory.mktemp("robot"))


def live(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "epg", "live", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=60, check=False)


def start(*arguments: str | Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "epg", "live", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)


# The client


def test_a_target_describes_itself(target: Target) -> None:
    with SerialPort(target.port) as port:
        client = Client(port)
        found = client.description
        client.stop()
    assert (found.name, found.node, found.period) == ("jiwy", "JIWY_node", 0.001)
    assert len(found.hash) == 16
    pan, tilt = found.setpoints
    assert pan == Setpoint("pan_subscriber", "rad", -0.05, 3.2, "", fresh=False, starts=0.0)
    assert (tilt.name, tilt.high) == ("tilt_subscriber", 1.6)
    assert ("inputs.position_pan", "rad") in [(signal.name, signal.unit) for signal in found.signals]
    assert [(signal.name, signal.unit) for signal in found.loop] == [
        ("loop.lateness", "ns"),
        ("loop.computation", "ns"),
    ]
    assert [signal.name for signal in found.replay] == [
        f"replay.{name}" for name in ("cycle", "parameter", "value", "acted", "untold")
    ]
    assert [(s.name, s.unit) for s in found.duties] == [("actuators.pwm_pan", ""), ("actuators.pwm_tilt", "")]
    positions = [("encoders.encoder_pan", "rad"), ("encoders.encoder_tilt", "rad")]
    assert [(s.name, s.unit) for s in found.positions] == positions
    assert found.streamed == found.signals + found.loop + found.replay + found.duties + found.positions
    assert len(found.model) == 16
    assert set(found.actuators) == {"pwm_pan", "pwm_tilt"}
    kp = next(parameter for parameter in found.parameters if parameter.name == "Pan\\PID\\kp")
    assert (kp.value, kp.generated, kp.unit) == (2.6, 2.6, "")


def test_a_stream_has_every_cycle_while_commands_are_answered(target: Target) -> None:
    rows: list[Rows] = []
    with SerialPort(target.port) as port:
        client = Client(port)
        names = [signal.name for signal in client.description.signals]
        client.start_stream(range(len(names)), 1, rows.append)
        for number in range(40):
            assert client.command(f"set Pan\\PID\\kp={number + 0.5}") == ["ok set"]
            assert (
                client.parameters()[[p.name for p in client.parameters()].index("Pan\\PID\\kp")].value == number + 0.5
            )
        client.stop_stream()
        assert client.damaged == 0
        with pytest.raises(CommandRefused, match="there is no parameter 'nonsense'"):
            client.command("set nonsense=1")
        client.stop()
    stream = Stream(names)
    taken = [row for each in rows for row in stream.take(each)]
    assert stream.dropped == 0 or target.was_late()
    assert len(taken) > 100
    timed = [(row.time, row.values) for row in taken]
    check_every_cycle_has_a_row(names, timed, target.cycles(), dropped=(stream.dropped,))


def test_a_port_belongs_to_one_program(target: Target) -> None:
    with SerialPort(target.port) as port:
        client = Client(port)
        done = live(target.port, "--duration", "1")
        client.stop()
    assert done.returncode == 1
    assert f"another program has {target.port}: " in done.stderr
    assert f"(process {os.getpid()})" in done.stderr
    with SerialPort(target.port):
        pass


def test_an_end_of_the_target_is_noticed(target: Target) -> None:
    told: list[str] = []
    with SerialPort(target.port) as port:
        client = Client(port, told.append)
        target.process.kill()
        until(lambda: told)
        assert told == [f"lost {target.port} is gone"]
        with pytest.raises(Lost):
            client.command("get")
        client.stop()


def test_a_port_without_a_target_is_not_a_target(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    name = Path(os.ttyname(theirs))
    os.close(theirs)
    with SerialPort(name) as port, pytest.raises(Lost, match="the target does not answer 'version'"):
        Client(port)
    os.close(ours)
    for path in (tmp_path / "missing", tmp_path, Path("/dev/null")):
        with pytest.raises(PortError):
            SerialPort(path)


@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_the_reason_why_reading_ended_is_told(target: Target) -> None:
    """The thread that reads has met an exception that nobody expected."""

    def told(line: str) -> None:
        raise ValueError(line)

    with SerialPort(target.port) as port:
        client = Client(port, told)
        with pytest.raises(Lost, match=r"EPG cannot read from the target: ValueError\('state enabled=0"):
            while True:
                client.disable()
        client.stop()


# Leases


def enabled_by(target: Target | Robot) -> subprocess.Popen[str]:
    """A program that has enabled the target on a lease."""
    program = start(target.port, "--send", "disable", "--send", "enable", "--duration", "60")
    assert program.stdout is not None
    first = program.stdout.readline() + program.stdout.readline()
    assert first == "ok disable\nok enable\n", first + (program.communicate()[1])
    return program


def kept_enabled(robot: Robot) -> subprocess.Popen[str]:
    """A program that has kept the robot enabled for longer than a lease."""
    for _ in range(5):  # a lease ends if the computer stops the program for longer
        program = enabled_by(robot)
        robot.wait(driven=True)
        if not soon(lambda: not robot.is_driven(), 2 * LEASE):  # longer than a lease, in which nothing may happen
            return program
        program.kill()
        program.communicate()
    raise AssertionError("five programs in turn have not kept the robot enabled")


def stopped(program: subprocess.Popen[str], number: signal.Signals) -> float:
    """Sends a signal; returns a monotonic time at which the program does nothing more."""
    program.send_signal(number)
    os.waitid(os.P_PID, program.pid, os.WEXITED | os.WSTOPPED | os.WNOWAIT)
    return time.monotonic()  # the program's end, compared with the target's time


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_actuator_is_safe_within_300_ms_and_a_cycle(
    robot_program: Path, tmp_path: Path, number: signal.Signals
) -> None:
    """In the time of the target.  tests/connect/browser/test_failures.py does the same with the page."""
    with Robot(robot_program, tmp_path) as robot:
        program = kept_enabled(robot)
        at = stopped(program, number)
        robot.wait(driven=False)
        program.kill()
        program.communicate()
        span = robot.spans()[-1]
        assert span.last <= at + LEASE + CYCLE


def stays_enabled(target: Target) -> None:
    with client_of(target.port) as client:
        let_pass(client, LEASE + LATE)
        assert "enabled=1" in client.command("stats")[0]


def test_a_program_does_not_disable_a_target_that_another_one_enabled(target: Target) -> None:
    with SerialPort(target.port) as port:
        client = Client(port)
        client.enable(unattended=True)
        client.stop()
    done = live(target.port, "--duration", "0.5")
    assert done.returncode == 0, done.stderr
    done = live(target.port, "--send", "enable", "--signals", "none")
    assert "the target is enabled already, without a lease" in done.stderr
    stays_enabled(target)


def test_without_a_lease_only_after_a_confirmation(target: Target) -> None:
    arguments = (target.port, "--signals", "none", "--send", "disable", "--send", "enable unattended")
    done = live(*arguments)
    assert done.returncode == 1 and "[unattended-not-confirmed]" in done.stderr
    done = live(*arguments, "--unattended")
    assert done.stdout.startswith("ok disable\nok enable\n"), done.stderr
    stays_enabled(target)


def test_an_enabling_names_the_newest_stop_that_was_known(target: Target) -> None:
    with SerialPort(target.port) as port:
        client = Client(port)
        client.disable()
        known = client.state["stop"]
        client.enable()
        client.disable()
        with pytest.raises(CommandRefused, match=f"stopped by program stop=(?!{known})"):
            client.enable(known)
        client.enable()
        client.stop()


# The command


def test_rows_are_recorded(target: Target, tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    done = live(target.port, "--duration", "1", "--signals", "position_pan,pwm_pan", "--csv", file, "--every", "2")
    assert done.returncode == 0, done.stderr
    with file.open() as opened:
        header, *rows = csv.reader(opened)
    assert header == ["time", "inputs.position_pan", "outputs.pwm_pan"]
    counted = re.fullmatch(rf"{len(rows)} rows, (\d+) dropped, 0 damaged frames", done.stdout.splitlines()[-1])
    assert counted and (counted[1] == "0" or target.was_late()), done.stdout
    again = live(target.port, "--duration", "1", "--csv", file)
    assert "this file exists" in again.stderr
    numbers = [[float(cell) for cell in row] for row in rows]
    timed = [(row[0], row) for row in numbers]
    check_every_cycle_has_a_row(header, timed, target.cycles(), every=2, dropped=(int(counted[1]),))
    assert numbers[-1][0] > 0.9


def rows_in(file: Path) -> int:
    """The rows that a recording has written so far."""
    return file.read_text().count("\n") - 1 if file.is_file() else 0


def csv_time(file: Path) -> float:
    """The time of the last whole row."""
    return float(file.read_text().split("\n")[-2].split(",")[0])


def mcap_times(file: Path) -> list[float]:
    """The seconds of the messages since the first one, up to the place where the file was cut off."""
    exceptions = pytest.importorskip("mcap.exceptions")
    from mcap.reader import NonSeekingReader

    times: list[int] = []
    with file.open("rb") as opened, contextlib.suppress(exceptions.McapError):
        times += (message.log_time for *_, message in NonSeekingReader(opened).iter_messages(log_time_order=False))
    return [1e-9 * (time - times[0]) for time in times]


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGTERM])
def test_the_files_are_complete_when_the_terminal_closes(
    target: Target, tmp_path: Path, number: signal.Signals
) -> None:
    reader = pytest.importorskip("mcap.reader")
    program = start(target.port, "--csv", tmp_path / "rows.csv", "--mcap", tmp_path / "rows.mcap")
    until(lambda: rows_in(tmp_path / "rows.csv") > 500)
    program.send_signal(number)
    program.send_signal(number)  # the system's and the shell's
    assert program.wait(10) == 0
    rows = (tmp_path / "rows.csv").read_text().splitlines()[1:]
    with (tmp_path / "rows.mcap").open("rb") as file:
        assert reader.make_reader(file).get_summary().statistics.message_count == len(rows) > 500


def test_the_files_are_complete_when_the_terminal_of_the_screen_closes(target: Target, tmp_path: Path) -> None:
    reader = pytest.importorskip("mcap.reader")
    files = ["--mcap", str(tmp_path / "rows.mcap"), "--csv", str(tmp_path / "rows.csv")]
    command = [sys.executable, "-m", "epg", "live", str(target.port), *files]
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(ROOT)
        os.environ["TERM"] = "xterm"
        os.execv(sys.executable, command)
    until(lambda: read_until(terminal, "\x1b") and rows_in(tmp_path / "rows.csv") > 500)
    os.close(terminal)
    os.waitpid(process, 0)
    with (tmp_path / "rows.mcap").open("rb") as file:
        assert reader.make_reader(file).get_summary().statistics.message_count > 500


def test_a_killed_recording_keeps_its_rows_up_to_the_last_second(target: Target, tmp_path: Path) -> None:
    files = [tmp_path / "rows.csv", tmp_path / "rows.mcap"]
    program = start(target.port, "--csv", files[0], "--mcap", files[1])
    until(lambda: rows_in(files[0]) > 0)
    reached = csv_time(files[0]) - time.monotonic()  # the recording goes on while nobody looks
    until(lambda: csv_time(files[0]) > 3.0)
    reached += time.monotonic()  # the recording goes on while nobody looks
    program.kill()
    program.wait()
    assert csv_time(files[0]) > reached - 1.0
    assert mcap_times(files[1])[-1] > reached - 1.0


def test_a_full_disk_names_the_file(target: Target) -> None:
    done = live(target.port, "--duration", "1", "--csv", "/dev/full", "--force")
    assert (done.returncode, done.stderr) == (4, "epg: /dev/full: No space left on device\n")


def test_rows_are_printed_as_json_and_a_closed_pipe_is_no_crash(target: Target) -> None:
    program = start(target.port, "--json", "--signals", "pwm_pan")
    assert program.stdout is not None and program.stderr is not None
    first = json.loads(program.stdout.readline())
    assert first["time"] == 0 and list(first["values"]) == ["outputs.pwm_pan"]
    program.stdout.close()
    assert program.wait(10) == 0
    assert program.stderr.read() == ""


def test_mistakes_are_explained(target: Target) -> None:
    for arguments, text in (
        (["--signals", "position_pam"], "there is no signal 'position_pam'"),
        (["--send", "gett"], "there is no command 'gett'"),
        (["--baud", "12345"], "have no rate of 12345"),
    ):
        done = live(target.port, *arguments)
        assert done.returncode == 1
        assert text in done.stderr and "hint: " in done.stderr


def test_the_space_bar_disables_on_the_screen(target: Target) -> None:
    process, terminal = pty.fork()
    if process == 0:
        os.chdir(ROOT)
        os.environ["TERM"] = "xterm"
        os.execv(sys.executable, [sys.executable, "-m", "epg", "live", str(target.port)])
    for typed, shown in (
        (b"", "inputs.position_pan"),
        (b" ", "enabled=0"),
        (b"enable\r", "enabled=1"),
        (b"pan_subscriber=0.5\r", "ok setpoint"),
        (b"", "enabled=1"),
        (b"\x1b[A\x1bOP ", "enabled=0 fault=none"),  # keys without a character leave the line empty
    ):
        os.write(terminal, typed)
        read_until(terminal, shown)
    os.write(terminal, b"\x03")
    _, status = os.waitpid(process, 0)
    assert os.waitstatus_to_exitcode(status) == 0
    assert not target.is_enabled()


def test_a_gain_is_kept_in_the_bindings(target: Target, tmp_path: Path) -> None:
    bindings = tmp_path / "jiwy.bindings.yaml"
    before = (ROOT / "examples/jiwy/jiwy.bindings.yaml").read_text() + "parameters:\n  Pan.PID.tauD: 0.05  # s\n"
    bindings.write_text(before)
    assert live(target.port, "--keep", bindings).stdout == "no parameter differs from those of the firmware\n"
    done = live(target.port, "--signals", "none", "--send", "set Pan\\PID\\kp=2.2 Pan\\PID\\tauD=0.04")
    command = f"epg live {target.port} --keep jiwy.bindings.yaml"
    assert done.stdout == (
        f"ok set\nchanged parameters: Pan\\PID\\kp=2.2 Pan\\PID\\tauD=0.04\nhint: '{command}' keeps them\n"
    )
    assert bindings.read_text() == before
    done = live(target.port, "--keep", bindings)
    assert done.stdout == f"{bindings} has Pan\\PID\\kp=2.2 Pan\\PID\\tauD=0.04\n", done.stderr
    assert bindings.read_text() == before.replace("0.05  # s\n", "0.04  # s\n  'Pan\\PID\\kp': 2.2\n")
    bindings.write_text("version: 1\nmodel: 5\n")
    wrong = live(target.port, "--keep", bindings)
    assert wrong.returncode == 1 and "jiwy.bindings.yaml:2:8: error" in wrong.stderr


def test_a_fault_is_said_in_words(target: Target) -> None:
    """The axis is pressed against its end stop by a setpoint at its limit, and by a gain that is much too large."""
    lines = ("disable", "set Tilt\\PID\\kp=50", "tilt_subscriber=-0.05", "enable")
    commands = [word for line in lines for word in ("--send", line)]
    done = live(target.port, *commands, "--signals", "none", "--duration", "3")
    assert done.returncode == 0, done.stderr
    assert (
        "Fault 'stall' of guard_tilt: a driven motor gave no counts: the encoder is dead, or the motor" in done.stderr
    )
    assert "The setpoint tilt_subscriber is at its limit." in done.stderr
    assert "hint: Send another setpoint, which does not press the axis against its end stop" in done.stderr
    again = ("set Tilt\\PID\\kp=1.4", "tilt_subscriber=0")
    assert (
        live(target.port, *(word for line in again for word in ("--send", line)), "--duration", "0.1").returncode == 0
    )


def test_a_setpoint_outside_of_the_axis_is_refused(target: Target) -> None:
    done = live(target.port, "--send", "tilt_subscriber=-0.5", "--signals", "none", "--duration", "0.1")
    assert "tilt_subscriber must be from -0.05 to 1.6 rad" in done.stderr


def test_the_program_of_the_page(target: Target) -> None:
    page = (ROOT / "docs/live-protocol.md").read_text(encoding="utf-8")
    (program,) = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    program = program.replace("/dev/ttyACM0", str(target.port))
    done = subprocess.run([sys.executable, "-c", program], cwd=ROOT, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    first, *rows = done.stdout.splitlines()
    assert first == "jiwy pan_subscriber tilt_subscriber"
    ticks = [float(row.split()[0]) for row in rows]
    assert len(rows) > 10 and ticks == sorted(set(ticks))
