# SPDX-License-Identifier: Apache-2.0
"""The time between two turns of communication while USB or a UART is flooded, and the ticks of core 1 meanwhile.

The images run from flash.  The emulator simulates its cache and the contention of the cores; from its start on, core 1
must not access flash.
"""

from __future__ import annotations

import itertools
import random
import struct
from array import array
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from epg.live.client import Rows
from epg.live.frames import Decoder, encode
from epg.live.rows import Stream
from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import CYCLES_PER_MILLISECOND, Emulator
from tests.doubles.xrce_agent.messages import float64
from tests.platforms.pico.closed_loop.robot import connect
from tests.platforms.pico.images import images
from tests.platforms.pico.xrce.agent import BoardAgent, UartLink, UsbLink

LINES = "pan_subscriber=0.4 tilt_subscriber=0.4\nstats\nports\nhelp\nnonsense\nget\nwatch\n"
"""A session on the console, repeated as fast as the line takes it."""
AGENT, CONSOLE = 0, 1
"""Serial ports on USB."""
NODE_BAUD, CONSOLE_BAUD = 460800, 921600
"""Of the agent's line and of the console's: node.tcf.in and wired.tcf.in."""
BYTES_PER_SECOND = 800_000
"""More than USB carries to one port."""
UART = 0
JIWY_SIGNALS = 10
CHANGE_MS = 5
"""Time between two changes of a parameter while a program streams signals."""


@dataclass(frozen=True)
class Polls:
    """One load.  Times in cycles of 8 ns."""

    load: str
    turns: int
    longest: int
    """From the begin of a turn of communication to that of the next one, at most."""
    ticks: int
    deviations: frozenset[int]
    """Of the ticks of core 1 from t0 + k T."""
    faults: int


@dataclass(frozen=True)
class Streamed:
    """What a program on the console has received: rows of a stream, and answers."""

    rows: int
    dropped: int
    damaged: int
    answers: int
    values: list[float]
    """Of the first signal."""


class _Recorder(UsbLink):
    """A link that can keep the agent's frames."""

    kept: list[bytes] | None = None

    def send_raw(self, peer: Any, data: bytes) -> None:
        if self.kept is None:
            super().send_raw(peer, data)
        else:
            self.kept.append(data)


class _UartRecorder(UartLink, _Recorder):
    kept: list[bytes] | None = None

    def send_raw(self, peer: Any, data: bytes) -> None:
        if self.kept is None:
            UartLink.send_raw(self, peer, data)
        else:
            self.kept.append(data)


def measure_usb(platform: str, milliseconds: int, seed: int = 3) -> Iterator[Polls]:
    """The agent and the console are on USB; each load lasts this long."""
    elf = images("pico", platform, "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    with _started(elf, seed) as pico:
        pico.call("usb_open", port=CONSOLE)
        pico.run(milliseconds=5)
        link = _Recorder(pico, AGENT)
        with BoardAgent(pico, link) as agent:
            agent.wait_for("rt/pan_publisher")
            agent.run(milliseconds)
            yield _polls(pico, "USB: an agent connects")
            pico.send(_frames(agent, link, BYTES_PER_SECOND * milliseconds // 1000), port=AGENT)
            pico.run(milliseconds=milliseconds)
            yield _polls(pico, "USB: setpoints of the agent")
            pico.call("usb_flood", text=LINES, port=CONSOLE)
            pico.run(milliseconds=milliseconds)
            yield _polls(pico, "USB: setpoints of the agent, lines on the console")
        pico.call("usb_flood", seed=seed, port=CONSOLE)
        pico.call("usb_flood", seed=seed + 1, port=AGENT)
        pico.run(milliseconds=milliseconds)
        yield _polls(pico, "USB: garbage on both ports")


def measure_live(platform: str, milliseconds: int, seed: int = 3) -> Iterator[tuple[Polls, Streamed]]:
    """A program on the console streams 20 signals in every cycle and changes a parameter every 5 ms."""
    elf = images("pico", platform, "user_jiwy", middleware="xrce_console") / "user_jiwy.elf"
    with _started(elf, seed) as pico:
        pico.call("usb_open", port=CONSOLE)
        pico.run(milliseconds=5)
        pico.receive_bytes(port=CONSOLE)
        _polls(pico, "start")
        streamed = _stream(pico, milliseconds)
        yield _polls(pico, "USB: a program streams 20 signals and changes parameters"), streamed
        pico.call("usb_flood", seed=seed, port=AGENT)
        streamed = _stream(pico, milliseconds)
        yield _polls(pico, "USB: the same, with garbage at the agent's port"), streamed


def _stream(pico: Emulator, milliseconds: int, signals: int = 20) -> Streamed:
    decoder, stream = Decoder(), Stream(["signal"] * signals)
    answers = 0
    values: list[float] = []

    def take() -> None:
        nonlocal answers
        for part in decoder.feed(pico.receive_bytes(port=CONSOLE)):
            assert isinstance(part, bytes)
            if part.startswith(b"A\2ok set"):
                answers += 1
            elif part.startswith(b"D"):
                number, tick = struct.unpack_from("<IQ", part, 1)
                rows = Rows(number, tick / 1e9, array("f", part[13:]))
                values.extend(row.values[0] for row in stream.take(rows))

    numbers = [index % JIWY_SIGNALS for index in range(signals)]
    pico.send(encode(b"S\1" + struct.pack(f"<I{signals}H", 1, *numbers)), port=CONSOLE)
    for step in range(milliseconds // CHANGE_MS):
        pico.send(encode(b"C\2set Pan\\PID\\kp=%f" % (2.0 + step / 100)), port=CONSOLE)
        pico.run(milliseconds=CHANGE_MS)
        take()
    pico.send(encode(b"S\3"), port=CONSOLE)
    pico.run(milliseconds=CHANGE_MS)
    take()
    return Streamed(stream.rows, stream.dropped, decoder.damaged, answers, values)


def measure_uart(platform: str, milliseconds: int, seed: int = 3) -> Iterator[Polls]:
    """The agent is on a UART, and the console on USB; then the console is on a UART."""
    draw = random.Random(seed)
    with _started(_uart_image(platform, "node_firmware"), seed) as pico:
        pico.call("usb_open", port=0)
        link = _UartRecorder(pico, UART, NODE_BAUD)
        with BoardAgent(pico, link) as agent:
            agent.wait_for("rt/pan_publisher")
            pico.call("usb_flood", text=LINES)
            yield _flooded(pico, "UART: setpoints of the agent; USB: lines on the console", NODE_BAUD, milliseconds,
                           _frames(agent, link, NODE_BAUD * milliseconds // 10_000))  # fmt: skip
        pico.call("usb_flood", seed=seed)
        garbage = draw.randbytes(NODE_BAUD * milliseconds // 10_000)
        yield _flooded(pico, "UART: garbage; USB: garbage", NODE_BAUD, milliseconds, garbage)
    with _started(_uart_image(platform, "wired_firmware"), seed) as pico:
        lines = (LINES * milliseconds).encode()[: CONSOLE_BAUD * milliseconds // 10_000]
        yield _flooded(pico, "UART: lines on the console", CONSOLE_BAUD, milliseconds, lines)


def _uart_image(platform: str, name: str) -> Path:
    return build("tests/platforms/pico/uart/project", targets=[name], variables={"PLATFORM": platform}) / f"{name}.elf"


def _started(elf: Path, seed: int) -> Emulator:
    """The board after its start, with JIWY on its pins."""
    pico = Emulator(elf, wait_states=True, usb={"seed": seed, "open": False})
    connect(pico, {"pan": 0.12, "tilt": 0.12})
    pico.run_until("sleep_between_ticks", core=1)
    pico.call("forbid_flash", core=1)
    for name, core, function in (("turn", 0, "epg_control_alive"), ("tick", 1, "on_wrap")):
        pico.call("watch_span", name=name, core=core, **{"from": function, "to": "return"})
    pico.run(milliseconds=40)
    return pico


def _frames(agent: BoardAgent, link: _Recorder, size: int) -> bytes:
    """Valid frames of the agent with setpoints: at least ``size`` bytes."""
    link.kept = []
    while sum(map(len, link.kept)) < size:
        for topic in ("rt/pan_subscriber", "rt/tilt_subscriber") * 50:
            agent.topics.publish(topic, float64(0.4), reliable=False)
    data, link.kept = b"".join(link.kept), None
    return data


def _flooded(pico: Emulator, load: str, baud: int, milliseconds: int, data: bytes) -> Polls:
    pico.call("uart_send", uart=UART, baud=baud, hex=data.hex())
    pico.run(milliseconds=milliseconds)
    return _polls(pico, load)


def _polls(pico: Emulator, load: str) -> Polls:
    """Takes what was recorded since the last call."""
    turns = [passage[0] for passage in pico.call("span", name="turn")["passages"]]
    ticks = [passage[0] for passage in pico.call("span", name="tick")["passages"]]
    longest = max(later - sooner for sooner, later in itertools.pairwise(turns))
    deviations = frozenset(tick - ticks[0] - k * CYCLES_PER_MILLISECOND for k, tick in enumerate(ticks))
    return Polls(load, len(turns), longest, len(ticks), deviations, len(pico.call("faults")))
