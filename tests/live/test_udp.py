# SPDX-License-Identifier: Apache-2.0
"""The console by UDP, with a real target: JIWY with its simulated plant, in real time."""

from __future__ import annotations

import csv
import random
import socket
import struct
import subprocess
import time
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from epg.live import frames
from epg.live.client import Client, Rows, words_of
from epg.live.port import PortError
from epg.live.udp import PortTaken, UdpPort, disable, parse
from tests.waiting import PATIENCE, until, waited

from .target import check_every_cycle_has_a_row, client_of, let_pass, now
from .test_live import live
from .udp_target import UdpTarget, is_soon_disabled

BEGIN, END, DISABLE = 1, 2, 4
RUNNING, OVER, DISABLED, TAKEN = 1, 2, 4, 8
KEPT = 0.7
"""Seconds of rows of 20 signals for which a target has memory, until its communication thread has a processor."""


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path) -> Iterator[UdpTarget]:
    found = UdpTarget(jiwy_host, tmp_path)
    yield found
    found.process.kill()
    found.process.communicate()


class Person:
    """A person with a program such as ``nc -u``."""

    def __init__(self, target: UdpTarget) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", target.number))
        self.socket.settimeout(PATIENCE)

    @property
    def name(self) -> str:
        return "{}:{}".format(*self.socket.getsockname())

    def ask(self, line: str, end: str | tuple[str, ...]) -> str:
        """The text up to the first line that begins with ``end``."""
        self.socket.send(f"{line}\n".encode())
        text = ""
        while not any(each.startswith(end) for each in text.splitlines()):
            text += self.socket.recv(4096).decode("ascii")
        return text


class Program:
    """A program that makes its datagrams by itself."""

    def __init__(self, target: UdpTarget, session: int = 77) -> None:
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.connect(("127.0.0.1", target.number))
        self.socket.settimeout(PATIENCE)
        self.session = session
        self._lines: dict[int, str] = {}

    def send(self, flags: int, number: int = 0, line: str = "", lowest: int = 0, received: int = 0) -> None:
        body = frames.encode(b"C\1" + line.encode()) if line else b""
        self.socket.send(struct.pack("<4sBIIII", b"\x01EPG", flags, self.session, number, received, lowest) + body)

    def flags(self) -> int:
        """The flags of the next datagram."""
        return self.socket.recv(4096)[4]

    def lines(self, last: str) -> list[str]:
        """All lines of answers so far, in their order, as soon as one that begins with ``last`` is the newest.

        The target repeats them, because this program confirms none.
        """

        def take() -> bool:
            data = self.socket.recv(4096)
            flags, _, number = struct.unpack_from("<BII", data, 4)
            if flags == RUNNING:
                for part in filter(None, data[21:].split(b"\0")):
                    self._lines[number] = (frames.decode(part) or b"").decode("ascii")[2:]
                    number += 1
            return bool(self._lines) and self._lines[max(self._lines)].startswith(last)

        until(take, lambda: f"no line {last}: {self._lines}", pause=0.0)
        return [self._lines[number] for number in sorted(self._lines)]


def gaps(got: list[Rows], width: int) -> int:
    """In how many places rows of ``width`` values are missing, also before the first one."""
    numbers = [0, *(rows.number + len(rows.values) // width for rows in got)]
    assert all(before <= rows.number for before, rows in zip(numbers, got)), "no row comes twice"
    return sum(before < rows.number for before, rows in zip(numbers, got))


def dropped(client: Client) -> int:
    """How many datagrams to ``client`` Linux has dropped because a late computer did not let this process read them."""
    own = client._port._socket.getsockname()[1]  # type: ignore[attr-defined]
    sockets = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    (found,) = [int(words[-1]) for words in sockets if int(words[1].rpartition(":")[2], 16) == own]
    return found


# A program


def test_a_target_by_udp_does_what_one_on_a_cable_does(target: UdpTarget) -> None:
    assert target.said == f"jiwy: the console listens on {target.port}\n"
    with client_of(target.port) as client:
        found = client.description
        assert (found.name, found.node) == ("jiwy", "JIWY_node")
        assert ("inputs.position_pan", "rad") in [(signal.name, signal.unit) for signal in found.signals]
        assert client.command("disable") == ["ok disable"]
        assert client.command("jog pwm_pan 0.1 100")[-1] == "ok jog"
        assert client.command("set Pan\\PID\\kp=2.2") == ["ok set"]
        assert "parameter Pan\\PID\\kp=2.2 generated=2.6" in client.command("get")
        assert client.command("capture position_pan outputs.pwm_pan rows=1000") == ["ok capture rows=1000"]
        let_pass(client, 1.5)
        recorded = client.command("capture read")
        assert len([line for line in recorded if line.startswith("csv ")]) == 1001
        assert client.enable() == ["ok enable"]
        let_pass(client, 1)
        assert "enabled=1 leased=1" in client.command("stats")[0]
    until(lambda: "enabled=0" in client_status(target))
    target.end()


def client_status(target: UdpTarget) -> str:
    with client_of(target.port) as client:
        return client.command("stats")[0]


def test_a_stream_of_20_signals_has_every_cycle(target: UdpTarget) -> None:
    got: list[Rows] = []
    with client_of(target.port) as client:
        count = len(client.description.streamed)
        chosen = [*range(count), *range(20 - count)]
        client.start_stream(chosen, 1, got.append)
        for number in range(100):
            assert client.command(f"set Pan\\PID\\kp={number + 0.5}") == ["ok set"]
            assert f"parameter Pan\\PID\\kp={number + 0.5} generated=2.6" in client.command("get")
        until(lambda: sum(len(rows.values) // 20 for rows in got) > 2000)
        client.stop_stream()
        assert client.damaged == 0
        assert gaps(got, 20) <= dropped(client) or waited(target.process.pid) > KEPT


def test_the_command_line_records_and_asks(target: UdpTarget, tmp_path: Path) -> None:
    done = live(target.port, "--duration", "1", "--signals", "position_pan", "--csv", tmp_path / "rows.csv")
    assert done.returncode == 0, done.stderr
    assert " 0 dropped, 0 damaged frames" in done.stdout
    with (tmp_path / "rows.csv").open() as file:
        header, *rows = csv.reader(file)
    numbers = [[float(cell) for cell in row] for row in rows]
    assert numbers[-1][0] > 0.8
    assert live(target.port, "--send", "get Pan\\PID\\kp", "--signals", "none").stdout == (
        "parameter Pan\\PID\\kp=2.6\nok get\n"
    )
    check_every_cycle_has_a_row(header, [(row[0], row) for row in numbers], target.end())


def test_the_end_of_a_target_is_noticed(target: UdpTarget) -> None:
    told: list[str] = []
    with UdpPort(target.port) as port:
        client = Client(port, told.append)
        target.end()
        client._over.wait(5)
        assert told == [f"lost the program has closed {target.port}"]
        client.stop()
    with pytest.raises(PortError, match=f"no program has {target.port}"):
        UdpPort(target.port)


# One user at a time


def test_a_second_program_is_told_who_has_the_target_and_may_disable_it(target: UdpTarget) -> None:
    told: list[str] = []
    with UdpPort(target.port) as port:
        client = Client(port, told.append)
        client.disable()
        client.enable()
        own = "{}:{}".format(*port._socket.getsockname())
        with pytest.raises(PortTaken, match=f"another program has {target.port}: {own}"):
            UdpPort(target.port)
        assert "enabled=1" in client.command("stats")[0]
        done = live(target.port, "--duration", "1")
        assert done.returncode == 1 and f"another program has {target.port}: {own}" in done.stderr
        assert f"hint: end it; 'epg live {target.port} --send disable' disables" in done.stderr
        assert "enabled=1" in client.command("stats")[0]

        begin = now(client)
        disable(target.port)
        assert now(client) - begin < 0.2
        assert is_soon_disabled(client)
        assert [line for line in told if line.startswith("state enabled=0 fault=none ") and line.endswith(" by=other")]

        client.enable()
        done = live(target.port, "--send", "disable")
        assert (done.returncode, done.stdout) == (0, "ok disable\n")
        assert is_soon_disabled(client)

        client.enable()
        person = Person(target)
        assert person.ask("get", "error") == f"error line {own} has this target: only disable acts\r\n"
        assert "enabled=1" in client.command("stats")[0]
        assert person.ask("  disable now", "ok") == "ok disable\r\n"
        assert is_soon_disabled(client)
        client.stop()


def test_a_silent_program_leaves_the_target_to_another_one(target: UdpTarget) -> None:
    first = Program(target)
    first.send(BEGIN)
    assert first.flags() == RUNNING
    first.send(0, 1, "stats", lowest=1)
    begin = float(dict(words_of(first.lines("ok stats")[0]))["time"])
    with client_of(target.port) as client:
        assert 1.5 < now(client) - begin < 3
        first.send(BEGIN)
        until(lambda: first.flags() == OVER, "a session does not begin again")
        first.send(0)
        assert first.flags() == OVER
    second = Program(target, 78)
    second.send(BEGIN)
    assert second.flags() == RUNNING, "the client has said goodbye"
    second.send(END)
    second.send(BEGIN)
    assert second.flags() == OVER


# A person


def test_a_person_types_lines(target: UdpTarget) -> None:
    person = Person(target)
    text = person.ask("get Pan\\PID\\kp", "ok get")
    assert text.startswith("ready node=JIWY_node ")
    assert text.endswith("\r\nparameter Pan\\PID\\kp=2.6\r\nok get\r\n")
    assert person.ask("disable", "ok").endswith("state enabled=0 fault=none by=line\r\nok disable\r\n")
    assert "port signal inputs.position_pan unit=rad" in person.ask("ports", "ok ports")
    person.ask("watch position_pan", "ok watch")
    shown = person.ask("", "watch ")
    while float(shown.split()[1]) < 2.5:
        shown = person.socket.recv(4096).decode("ascii")
        assert shown.startswith("watch "), "nobody else wants the target"
    person.ask("watch off", "ok watch")
    other = Person(target)
    assert other.ask("get", "error") == f"error line {person.name} has this target: only disable acts\r\n"
    until(lambda: "ok get" in other.ask("get Pan\\PID\\kp", ("ok get", "error")), "the other one is silent", pause=0.1)
    assert person.ask("get", "error") == f"error line {other.name} has this target: only disable acts\r\n"
    with client_of(target.port) as client:
        assert "enabled=0" in client.command("stats")[0]


# Datagrams


def test_a_command_acts_once_and_not_after_a_later_disable(target: UdpTarget) -> None:
    program = Program(target)
    program.send(BEGIN)
    program.send(DISABLE, 1, "disable", lowest=1)
    program.lines("ok disable")
    for _ in range(5):
        program.send(0, 2, "jog pwm_pan 0.1 50")
    assert [line.split(" ")[0] for line in program.lines("ok jog")][-3:] == ["moved", "moved", "ok"]
    program.send(0, 4, "set Pan\\PID\\kp=1", lowest=1)
    program.send(0, 3, "set Pan\\PID\\kd=1", lowest=1)  # it was overtaken, and nothing forbids it
    program.send(DISABLE, 6, "disable", lowest=6)
    program.send(0, 5, "enable", lowest=1)  # it was overtaken by `disable`
    program.send(0, 4, "set Pan\\PID\\kp=1", lowest=1)
    assert "ok enable" not in program.lines("ok disable")
    trace = target.end()
    starts = [
        now["plant.inputs.duty_pan"]
        for before, now in pairwise(trace)
        if before["plant.inputs.duty_pan"] == 0 != now["plant.inputs.duty_pan"]
    ]
    assert starts == [0.1]
    assert trace[-1]["enabled"] == 0


@pytest.mark.parametrize("used", [True, False])
def test_garbage_does_nothing(target: UdpTarget, used: bool) -> None:
    chance = random.Random(7)
    senders = [socket.socket(socket.AF_INET, socket.SOCK_DGRAM) for _ in range(5)]
    before = client_status(target)
    got: list[Rows] = []

    def throw() -> None:
        for _ in range(3000):
            kind = chance.randrange(5)
            size = chance.choice((0, 1, 2, 20, 21, 22, 300, 1400, 2047, 2048, 9000, 65507))
            data = chance.randbytes(size)
            if kind == 0:  # a right header
                flags = chance.randrange(256) & ~(DISABLE | BEGIN)
                data = struct.pack("<4sBIIII", b"\x01EPG", flags, *(chance.randrange(1 << 32) for _ in range(4))) + data
            elif kind == 1:
                data = b"\0" * size
            elif kind == 2:
                data = b"enable\0\n" + data
            elif kind == 3:
                data = frames.encode(b"C\1enable")
            chance.choice(senders).sendto(data[:65507], ("127.0.0.1", target.number))
            time.sleep(0.0005)  # the socket's buffer is not flooded

    if used:
        with client_of(target.port) as client:
            client.command("disable")
            client.start_stream([0], 1, got.append)
            throw()
            assert "enabled=0" in client.command("stats")[0]
            client.stop_stream()
            assert gaps(got, 1) <= dropped(client) or waited(target.process.pid) > KEPT
    else:
        throw()
        assert client_status(target).split()[1] == before.split()[1]
    target.end()


# Mistakes


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["--console-udp", "7000"], 2, "error: --console-udp without --realtime\n"),
        (["--realtime", "--console-udp", "x"], 2, "error: --console-udp 'x' is not [ADDRESS:]PORT\nhint: for example "),
        (["--realtime", "--console-udp", "65536"], 2, "error: --console-udp '65536' is not [ADDRESS:]PORT\n"),
        (["--realtime", "--console-udp", "::1:7000"], 2, "error: --console-udp '::1:7000' is not [ADDRESS:]PORT\n"),
        (["--realtime", "--console-udp=:70"], 2, "error: --console-udp ':70' is not [ADDRESS:]PORT\n"),
        (
            ["--realtime", "--console", "--console-udp", "7000"],
            2,
            "error: --console and --console-udp\nhint: a target has one console: remove one of the options\n",
        ),
        (
            ["--realtime", "--console-udp", "192.0.2.1:7000"],
            1,
            "error: --console-udp 192.0.2.1:7000: this computer does not have this address\nhint: 'ip address' lists",
        ),
    ],
)
def test_a_wrong_address_of_a_program(jiwy_host: Path, options: list[str], status: int, message: str) -> None:
    done = subprocess.run([jiwy_host, *options], capture_output=True, text=True, timeout=20, check=False)
    assert (done.returncode, done.stdout) == (status, "")
    assert done.stderr.startswith(message), done.stderr


def test_a_port_in_use_and_ipv6(jiwy_host: Path, tmp_path: Path) -> None:
    first = UdpTarget(jiwy_host, tmp_path, "[::1]:0")
    try:
        assert str(first.port).startswith("udp:[::1]:")
        address = str(first.port).removeprefix("udp:")
        done = subprocess.run(
            [jiwy_host, "--realtime", "--console-udp", address], capture_output=True, text=True, timeout=20, check=False
        )
        assert (done.returncode, done.stderr) == (
            1,
            f"error: --console-udp {address}: another program uses this port\nhint: end it, or choose another port\n",
        )
        assert "enabled=1" in client_status(first)
    finally:
        first.end()


def test_wrong_names_of_a_port() -> None:
    for name in ("udp:", "udp:x", "udp:0", "udp:1:2:3", "udp:host:", "udp:[::1:7000", "udp:host:70000", "udp://a:7"):
        with pytest.raises(PortError, match="is not udp:HOST:PORT"):
            parse(name)
    assert parse("udp:robot:7000") == ("robot", 7000)
    done = live("udp:host", "--signals", "none")
    assert done.returncode == 1 and "'udp:host' is not udp:HOST:PORT" in done.stderr and "hint: " in done.stderr
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as silent:
        silent.bind(("127.0.0.1", 0))
        name = f"udp:127.0.0.1:{silent.getsockname()[1]}"
        with pytest.raises(PortError, match=f"nothing answers at {name}"):
            UdpPort(Path(name))


@pytest.mark.parametrize(
    ("address", "who"),
    [
        ("0.0.0.0:0", "anyone who can send datagrams to this address"),
        ("127.0.0.1:0", "every program of this computer"),
    ],
)
def test_an_open_console_warns(jiwy_host: Path, tmp_path: Path, address: str, who: str) -> None:
    target = UdpTarget(jiwy_host, tmp_path, address, options=("--console-open",))
    assert target.process.stderr is not None
    assert target.process.stderr.readline() == f"jiwy: warning: {who} can move the robot\n"
    with client_of(Path(f"udp:{target.number}")) as client:
        assert client.description.name == "jiwy"
    target.end()
