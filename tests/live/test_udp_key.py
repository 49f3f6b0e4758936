# SPDX-License-Identifier: Apache-2.0
"""The key of a console by UDP, with a real target, and with somebody between the target and its user."""

from __future__ import annotations

import os
import pty
import random
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from epg.live.client import Rows
from epg.live.port import PortError
from epg.live.udp import PortLocked, PortTaken, UdpPort, disable
from epg.live.udp_keys import file_of, keep_key, kept_key, read_key
from epg.live.udp_seal import Seal
from tests.waiting import read_until, until

from .target import client_of, now
from .test_live import ROOT, live
from .udp_target import UdpTarget, is_soon_disabled

KEY = "0011-2233-4455-6677-8899-aabb-ccdd-eeff"
RUNNING, OVER, DISABLED, LOCKED = 1, 2, 4, 64


@pytest.fixture(autouse=True)
def own_keys(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    file = tmp_path / "console.key"
    file.write_text(KEY + "\n")
    file.chmod(0o600)
    return file


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path, key_file: Path) -> Iterator[UdpTarget]:
    found = UdpTarget(jiwy_host, tmp_path, options=("--console-key", str(key_file)))
    yield found
    found.process.kill()
    found.process.communicate()


# The user


def test_a_program_on_the_network_prints_its_key(jiwy_host: Path, tmp_path: Path) -> None:
    target = UdpTarget(jiwy_host, tmp_path, "0.0.0.0:0")
    try:
        assert target.process.stderr is not None
        said, sign, key = target.process.stderr.readline().rstrip().rpartition(": ")
        assert (said, sign) == ("jiwy: the key of the console, until this program ends", ": ")
        assert len(read_key(key)) == 16
        port = Path(f"udp:127.0.0.1:{target.number}")
        with pytest.raises(PortLocked, match=f"{port} needs a key"):
            UdpPort(port)
        keep_key(port, key)
        assert file_of(port).stat().st_mode & 0o777 == 0o600
        assert file_of(port).parent.stat().st_mode & 0o777 == 0o700
        with client_of(port) as client:
            assert client.description.name == "jiwy"
    finally:
        target.end()


def test_everything_works_with_the_key(target: UdpTarget) -> None:
    keep_key(target.port, KEY)
    got: list[Rows] = []
    with client_of(target.port) as client:
        client.disable()
        assert client.enable() == ["ok enable"]
        client.start_stream([0, 1], 1, got.append)
        until(lambda: sum(len(rows.values) for rows in got) > 1000)
        assert "enabled=1 leased=1" in client.command("stats")[0]
        client.stop_stream()
        assert client.damaged == 0
        with pytest.raises(PortTaken, match="another program has"):
            UdpPort(target.port)
        assert "enabled=1" in client.command("stats")[0]
        begin = now(client)
        disable(target.port)
        assert now(client) - begin < 0.5
        assert is_soon_disabled(client)
    target.end()


def test_wrong_keys(target: UdpTarget, tmp_path: Path) -> None:
    wrong = tmp_path / "wrong"
    wrong.write_text("00" * 16)
    done = live(target.port, "--key", wrong, "--send", "version", "--signals", "none")
    assert done.returncode == 1
    assert f"{target.port}: error: {target.port} has another key than the one that was given [live-port]" in done.stderr
    assert "'epg live" in done.stderr and "--key FILE" in done.stderr
    done = live(target.port, "--send", "disable")
    assert done.returncode == 1
    assert "'disable' was sent; something answers" in done.stderr and "switch the actuators' supply off" in done.stderr
    wrong.write_text("no key")
    done = live(target.port, "--key", wrong)
    assert done.returncode == 1 and "this is not the key of a console" in done.stderr
    file_of(target.port).unlink()
    done = live(target.port, "--send", "disable")  # without a key: stopping needs none
    assert (done.returncode, done.stdout) == (0, "ok disable\n")
    wrong.write_text(KEY)
    done = live(target.port, "--key", wrong, "--send", "stats", "--signals", "none")
    assert done.returncode == 0 and "enabled=0" in done.stdout, done.stderr
    assert "ok version" in live(target.port, "--send", "version", "--signals", "none").stdout, "the key is kept"


def test_a_terminal_asks_for_the_key(target: UdpTarget) -> None:
    command = [sys.executable, "-m", "epg", "live", str(target.port), "--signals", "none"]
    child, file = pty.fork()
    if child == 0:
        os.chdir(ROOT)
        os.execv(command[0], command)
    said = read_until(file, "has printed: ")
    os.write(file, KEY.encode() + b"\n")
    shown = read_until(file, "jiwy  EPG")  # the head of the screen
    os.kill(child, signal.SIGKILL)
    os.waitpid(child, 0)
    os.close(file)
    assert f"{target.port} needs a key" in said, said
    assert KEY not in said + shown, "the key is not shown"
    assert kept_key(target.port) == read_key(KEY)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--console-key", "nothing"], "error: --console-key nothing: No such file or directory\nhint: this makes a "),
        (
            ["--console-key", "open"],
            "error: --console-key open: other users may read or change it\nhint: chmod 600 open",
        ),
        (
            ["--console-key", "short"],
            "error: --console-key short: it does not have the 32 hexadecimal digits of a key\n",
        ),
        (["--console-key", "."], "error: --console-key .: it is not a file\n"),
        (["--console-key", "short", "--console-open"], "error: --console-key and --console-open\nhint: "),
    ],
)
def test_mistakes(jiwy_host: Path, tmp_path: Path, options: list[str], message: str) -> None:
    for name, mode in (("open", 0o640), ("short", 0o600)):
        (tmp_path / name).write_text(KEY[:20] if name == "short" else KEY)
        (tmp_path / name).chmod(mode)
    command = [jiwy_host, "--realtime", "--console-udp", "0", *options]
    done = subprocess.run(command, capture_output=True, text=True, timeout=20, check=False, cwd=tmp_path)
    assert done.returncode in (1, 2) and done.stderr.startswith(message), done.stderr


# Somebody in the network


class Between(threading.Thread):
    """Passes datagrams on between one client and a target, keeps them, and lets a test add others."""

    def __init__(self, number: int) -> None:
        super().__init__(daemon=True)
        self.front = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.front.bind(("127.0.0.1", 0))
        self.back = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.back.connect(("127.0.0.1", number))
        self.port = Path(f"udp:127.0.0.1:{self.front.getsockname()[1]}")
        self.client: tuple[str, int] | None = None
        self.to_target: list[bytes] = []
        self.to_client: list[bytes] = []
        self.blocks = False
        self.harms = False
        self.over = False

    def run(self) -> None:
        chance = random.Random(3)
        while not self.over:
            for ready in select.select([self.front, self.back], [], [], 0.1)[0]:
                if ready is self.front:
                    data, self.client = self.front.recvfrom(65536)
                    self.to_target.append(data)
                    if not self.blocks:
                        self.back.send(data)
                    if self.harms:
                        self.tell(data)  # reflected
                        self.tell(forged(chance, data))
                else:
                    data = self.back.recv(65536)
                    self.to_client.append(data)
                    if self.blocks:
                        continue
                    self.tell(data)
                    if self.harms:
                        self.tell(chance.choice(self.to_client))  # an old one
                        self.back.send(data)  # reflected
                        recorded = [data for data in self.to_target if not data[64] & 4]  # stopping needs no key
                        self.back.send(chance.choice(recorded))
                        self.back.send(forged(chance, chance.choice(recorded)))

    def tell(self, data: bytes) -> None:
        assert self.client is not None
        self.front.sendto(data, self.client)


def forged(chance: random.Random, data: bytes) -> bytes:
    """A sealed datagram with one wrong bit, but not in its flags."""
    changed = bytearray(data)
    at = chance.choice([*range(4, 64), *range(65, len(data))])
    changed[at] ^= 1 << chance.randrange(8)
    return bytes(changed)


def plain(flags: int, session: int) -> bytes:
    return struct.pack("<4sBIIII", b"\x01EPG", flags, session, 0, 0, 0)


def test_somebody_in_the_network_changes_nothing(target: UdpTarget) -> None:
    between = Between(target.number)
    between.start()
    keep_key(between.port, KEY)
    got: list[Rows] = []
    with client_of(between.port) as client:
        client.disable()
        between.harms = True
        client.start_stream([0], 1, got.append)
        for number in range(30):
            assert client.command(f"set Pan\\PID\\kp={number + 0.5}") == ["ok set"]
            assert f"parameter Pan\\PID\\kp={number + 0.5} generated=2.6" in client.command("get")
            between.tell(plain(OVER, client._port._session))  # type: ignore[attr-defined]
            between.tell(plain(RUNNING, client._port._session) + b"\0\x05A\x01ok\0")  # type: ignore[attr-defined]
        assert client.enable() == ["ok enable"]
        assert "enabled=1" in client.command("stats")[0]
        between.harms = False
        client.stop_stream()
        assert client.damaged == 0
    between.over = True
    numbers = [rows.number for rows in got]
    assert numbers == sorted(set(numbers)), "no row came twice"
    target.end()


def test_recorded_datagrams_do_nothing_after_a_restart(jiwy_host: Path, tmp_path: Path, key_file: Path) -> None:
    options = ("--console-key", str(key_file))
    target = UdpTarget(jiwy_host, tmp_path, options=options)
    between = Between(target.number)
    between.start()
    keep_key(between.port, KEY)
    with client_of(between.port) as client:
        client.disable()
        assert client.command("set Pan\\PID\\kp=9.5") == ["ok set"]
        assert client.enable() == ["ok enable"]
    number = target.number
    target.end()
    target = UdpTarget(jiwy_host, tmp_path, str(number), options=options)
    thief = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    thief.connect(("127.0.0.1", number))
    for _ in range(3):
        for data in between.to_target:
            thief.send(data)
    keep_key(target.port, KEY)
    with client_of(target.port) as client:  # nobody else has the target
        assert "parameter Pan\\PID\\kp=2.6" in client.command("get")
    between.over = True
    target.end()


@pytest.mark.parametrize("how", ["plain", "another key", "recorded"])
def test_forged_answers_to_disable_do_not_count(target: UdpTarget, how: str) -> None:
    between = Between(target.number)
    between.start()
    keep_key(between.port, KEY)
    disable(between.port)
    recorded = between.to_client[-1]
    between.blocks = True
    seen = len(between.to_target)

    def answer() -> None:
        while not between.over:
            time.sleep(0.02)  # the thief answers again and again
            for data in between.to_target[seen:][-1:]:
                session = struct.unpack_from("<I", data, 65)[0]
                other = Seal(bytes(16))
                other._own = data[4:20]
                other._begin(data[20:36])
                sealed = other.close(plain(DISABLED, session))
                between.tell({"plain": plain(DISABLED, session), "another key": sealed, "recorded": recorded}[how])

    threading.Thread(target=answer, daemon=True).start()
    with pytest.raises(PortError, match="'disable' was sent; something answers"):
        disable(between.port)
    between.over = True


def test_a_kept_key_is_not_given_up_because_somebody_says_so() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as liar:
        liar.bind(("127.0.0.1", 0))
        port = Path(f"udp:127.0.0.1:{liar.getsockname()[1]}")
        keep_key(port, KEY)

        def answer() -> None:
            while True:
                try:
                    data, sender = liar.recvfrom(4096)
                except OSError:
                    return
                session = struct.unpack_from("<I", data, 65)[0]
                for flags in (RUNNING, OVER):
                    liar.sendto(plain(flags, session), sender)

        threading.Thread(target=answer, daemon=True).start()
        with pytest.raises(PortError, match=f"nothing answers at {port}") as found:
            UdpPort(port)
        assert f"remove {file_of(port)}" in found.value.hint
