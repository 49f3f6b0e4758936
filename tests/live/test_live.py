# SPDX-License-Identifier: Apache-2.0
"""``epg live`` with a real target: JIWY with its simulated plant, in real time."""

from __future__ import annotations

import csv
import json
import os
import pty
import re
import select
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from epg.live.client import Client, Lost, Refused, Rows
from epg.live.port import Port, PortError

from .target import LATE, LEASE, Target
from .witness import CYCLE, Robot, build_robot

ROOT = Path(__file__).resolve().parents[2]


def live(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "epg", "live", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=60, check=False)


def start(*arguments: str | Path) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "epg", "live", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=ROOT)


# The client


def test_a_target_describes_itself(target: Target) -> None:
    with Port(target.port) as port:
        client = Client(port)
        found = client.description
        client.stop()
    assert (found.name, found.node, found.period) == ("jiwy", "JIWY_node", 0.001)
    assert len(found.hash) == 16
    assert found.setpoints == ("pan_subscriber", "tilt_subscriber")
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
    with Port(target.port) as port:
        client = Client(port)
        count = len(client.description.signals)
        client.start_stream(range(count), 1, rows.append)
        for number in range(40):
            assert client.command(f"set Pan\\PID\\kp={number + 0.5}") == ["ok set"]
            assert (
                client.parameters()[[p.name for p in client.parameters()].index("Pan\\PID\\kp")].value == number + 0.5
            )
        client.stop_stream()
        assert client.damaged == 0
        with pytest.raises(Refused, match="there is no parameter 'nonsense'"):
            client.command("set nonsense=1")
        client.stop()
    number = 0
    tick = rows[0].tick
    for found in rows:
        assert found.number == number
        assert found.tick == pytest.approx(tick, abs=1e-6)
        number += len(found.values) // count
        tick += len(found.values) // count * 0.001
    assert number > 100


def test_a_port_belongs_to_one_program(target: Target) -> None:
    with Port(target.port) as port:
        client = Client(port)
        done = live(target.port, "--duration", "1")
        client.stop()
    assert done.returncode == 1
    assert f"another program has {target.port}: " in done.stderr
    assert f"(process {os.getpid()})" in done.stderr
    with Port(target.port):
        pass


def test_an_end_of_the_target_is_noticed(target: Target) -> None:
    told: list[str] = []
    with Port(target.port) as port:
        client = Client(port, told.append)
        target.process.kill()
        end = time.monotonic() + 5
        while not told and time.monotonic() < end:
            time.sleep(0.01)
        assert told == [f"lost {target.port} is gone"]
        with pytest.raises(Lost):
            client.command("get")
        client.stop()


def test_a_port_without_a_target_is_not_a_target(tmp_path: Path) -> None:
    ours, theirs = pty.openpty()
    name = Path(os.ttyname(theirs))
    os.close(theirs)
    with Port(name) as port, pytest.raises(Lost, match="the target does not answer 'version'"):
        Client(port)
    os.close(ours)
    for path in (tmp_path / "missing", tmp_path, Path("/dev/null")):
        with pytest.raises(PortError):
            Port(path)


# Leases


def enabled_by(target: Target | Robot) -> subprocess.Popen[str]:
    """A program that has enabled the target on a lease."""
    program = start(target.port, "--send", "disable", "--send", "enable", "--duration", "60")
    assert program.stdout is not None
    first = program.stdout.readline() + program.stdout.readline()
    assert first == "ok disable\nok enable\n", first + (program.communicate()[1])
    return program


def test_a_target_stays_enabled_while_its_program_runs(target: Target) -> None:
    program = enabled_by(target)
    time.sleep(1.5)
    program.kill()
    program.communicate()
    assert target.is_enabled(), "it was asked at once"


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGSTOP])
def test_the_actuator_is_safe_within_300_ms_and_a_cycle(tmp_path: Path, number: signal.Signals) -> None:
    """In the time of the target.  tests/connect/browser/test_failures.py does the same with the page."""
    with Robot(build_robot(tmp_path / "build"), tmp_path) as robot:
        program = enabled_by(robot)
        time.sleep(1)
        assert robot.is_driven()
        program.send_signal(number)
        at = time.monotonic()
        robot.wait(driven=False)
        program.kill()
        program.communicate()
        (span,) = robot.spans()
        assert span.last <= at + LEASE + CYCLE


def test_the_fault_of_a_lease_that_has_ended_is_reported(target: Target) -> None:
    program = enabled_by(target)
    program.kill()
    program.communicate()
    time.sleep(LEASE + LATE)
    assert "state        disabled, faults 1, fault: operator" in target.report()


def test_a_program_does_not_disable_a_target_that_another_one_enabled(target: Target) -> None:
    with Port(target.port) as port:
        client = Client(port)
        client.command("enable")
        client.stop()
    done = live(target.port, "--duration", "0.5")
    assert done.returncode == 0, done.stderr
    done = live(target.port, "--send", "enable", "--signals", "none")
    assert "the target is enabled already, without a lease" in done.stderr
    time.sleep(LEASE + LATE)
    assert target.is_enabled()


# The command


def test_rows_are_recorded(target: Target, tmp_path: Path) -> None:
    file = tmp_path / "rows.csv"
    done = live(target.port, "--duration", "1", "--signals", "position_pan,pwm_pan", "--csv", file, "--every", "2")
    assert done.returncode == 0, done.stderr
    with file.open() as opened:
        header, *rows = csv.reader(opened)
    assert header == ["time", "inputs.position_pan", "outputs.pwm_pan"]
    assert [float(row[0]) for row in rows[:3]] == [0.0, 0.002, 0.004]
    assert 450 <= len(rows) <= 700
    assert done.stdout.splitlines()[-1] == f"{len(rows)} rows, 0 dropped, 0 damaged frames"
    again = live(target.port, "--duration", "1", "--csv", file)
    assert "this file exists" in again.stderr


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
    seen = ""

    def until(text: str) -> None:
        nonlocal seen
        end = time.monotonic() + 20
        while text not in seen:
            assert time.monotonic() < end, seen[-3000:]
            if select.select([terminal], [], [], 0.5)[0]:
                seen += os.read(terminal, 65536).decode("utf-8", "replace")
        seen = ""

    until("inputs.position_pan")
    os.write(terminal, b" ")
    until("enabled=0")
    os.write(terminal, b"enable\r")
    until("enabled=1")
    os.write(terminal, b"pan_subscriber=0.5\r")
    until("ok setpoint")
    time.sleep(1)
    until("enabled=1")
    os.write(terminal, b" ")
    until("enabled=0 fault=none")
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
    commands = [word for line in ("disable", "tilt_subscriber=-0.2", "enable") for word in ("--send", line)]
    done = live(target.port, *commands, "--signals", "none", "--duration", "3")
    assert done.returncode == 0, done.stderr
    assert (
        "Fault 'stall' of guard_tilt: a driven motor gave no counts: the encoder is dead, or the motor" in done.stderr
    )
    assert "hint: Look at the cables and the supply of motor and encoder, free the axis" in done.stderr


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
