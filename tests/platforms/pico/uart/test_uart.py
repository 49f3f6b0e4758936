# SPDX-License-Identifier: Apache-2.0
"""A serial line as transport: the console over a UART of the emulated chip; the test is its other end."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.pico.images import PLATFORMS, TARGETS, skip_unless_buildable, skip_unless_emulated

BAUD = 921600
RING = 256
"""Size in bytes of the ring buffer for received bytes: wired.tcf.in."""
MARGIN = 32
"""Bytes that are given up besides those that were overwritten: uart.c of the family."""
PROJECT = "tests/platforms/pico/uart/project"
EPG_PICO_ERROR_RESOURCE = 4


def image(platform: str, name: str = "wired_firmware") -> Path:
    return build(PROJECT, targets=[name], variables={"PLATFORM": platform}) / f"{name}.elf"


def machine(elf: Path) -> Iterator[Emulator]:
    with Emulator(elf) as pico:
        pico.call("uart_send", uart=0, baud=BAUD)
        yield pico
        assert pico.call("faults") == []


@pytest.fixture(params=PLATFORMS)
def pico(request: pytest.FixtureRequest) -> Iterator[Emulator]:
    skip_unless_emulated(request.param)
    for made in machine(image(request.param)):
        made.run(milliseconds=30)
        yield made


@pytest.fixture
def user() -> Iterator[Emulator]:
    """A user's program around the target, on bare metal, before its first instruction."""
    skip_unless_emulated("bare_metal")
    yield from machine(image("bare_metal", "user"))


def say(pico: Emulator, data: str | bytes, **options: object) -> None:
    pico.call("uart_send", uart=0, hex=(data.encode() if isinstance(data, str) else data).hex(), **options)


def heard(pico: Emulator) -> str:
    return bytes.fromhex(pico.call("uart_receive", uart=0)).decode(errors="replace")


def ask(pico: Emulator, line: str) -> str:
    heard(pico)
    say(pico, line + "\n")
    pico.run(milliseconds=30)
    return heard(pico)


@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_it_builds_without_a_warning(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    folder = build(PROJECT, board=board, targets=["wired_firmware"], variables={"PLATFORM": platform})
    sources = own_sources(folder)
    assert {"uart.c", "wired_app.c"} <= {file.name for file in sources}
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}


def test_the_baud_rate_is_reached(pico: Emulator) -> None:
    assert pico.call("uart", uart=0)["baud"] == pytest.approx(BAUD, rel=0.001)


def test_the_console_answers(pico: Emulator) -> None:
    assert heard(pico).startswith("ready node=JIWY_node ")
    assert ask(pico, "version").startswith("ok version name=wired node=JIWY_node ")
    stats = ask(pico, "stats")
    assert "stat overruns=0\r\n" in stats
    assert "stat missed=0\r\n" in stats
    assert stats.endswith("ok stats\r\n")


def test_every_byte_of_bursts_arrives(pico: Emulator) -> None:
    """Lines at the full rate, typed and deleted: the echo, twice as long, proves that all bytes arrived unchanged."""
    assert "ok echo" in ask(pico, "echo on")
    draw = random.Random(1)
    lines = ["".join(draw.choice("abcdefghijklmnopqrstuvwxyz0123456789") for _ in range(70)) for _ in range(40)]
    heard(pico)
    for line in lines:
        say(pico, line + "\x7f" * 70)
        pico.run(milliseconds=4)
    pico.run(milliseconds=10)
    assert heard(pico) == "".join(line + "\b \b" * 70 for line in lines)


def test_a_uart_of_somebody_else_is_left_alone(user: Emulator) -> None:
    user.run_until("main")
    user.write_word("stdio_first", 1)
    user.run(milliseconds=30)
    assert (user.word("started"), user.word("error")) == (0, EPG_PICO_ERROR_RESOURCE)


def test_bytes_without_room_are_counted(user: Emulator) -> None:
    """Communication stops for 10 ms: the ring buffer keeps the newest bytes, and the rest is counted as lost."""
    user.run(milliseconds=30)
    assert (user.word("started"), user.word("lost")) == (1, 0)
    user.write_word("service_off", 1)
    user.run(milliseconds=1)
    say(user, "#" * 600)
    user.run(milliseconds=12)
    assert user.word("service_off") == 0
    assert user.word("lost") == 600 - (RING - MARGIN)
    say(user, "\n")
    user.run(milliseconds=10)
    assert "ok version" in ask(user, "version")


def test_interrupts_off_for_longer_than_the_chip_can_hold(user: Emulator) -> None:
    """The DMA receives: the chip's FIFO of 32 bytes would be full after a third of a millisecond."""
    user.run(milliseconds=30)
    heard(user)
    user.write_word("interrupts_off", 1)
    user.run(milliseconds=1)
    say(user, "version\n" * 20)
    user.run(milliseconds=5)
    assert (user.word("interrupts_off"), heard(user)) == (1, "")
    user.run(milliseconds=50)
    assert user.word("interrupts_off") == 0
    assert heard(user).count("ok version") == 20
    assert user.word("lost") == 0


def test_damaged_bytes_are_dropped_and_counted(user: Emulator) -> None:
    """Wrong stop bits, and a device that sends at another rate."""
    user.run(milliseconds=30)
    say(user, "garbage", damaged=True)
    user.run(milliseconds=5)
    assert user.word("lost") == 7
    say(user, "other", baud=BAUD // 2)
    user.run(milliseconds=5)
    assert user.word("lost") == 12
    user.call("uart_send", uart=0, baud=BAUD)
    assert "ok version" in ask(user, "version")
