# SPDX-License-Identifier: Apache-2.0
"""The emulator's USB host: serial port in both directions, cable, bus reset, reboot by picotool's request."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from .emulator import CYCLES_PER_MILLISECOND, Emulator

USB_INTERRUPT = 16 + 5


@pytest.fixture
def pico(programs: Path) -> Iterator[Emulator]:
    with Emulator(programs / "serial.elf", usb={"seed": 4}) as machine:
        machine.run_until_text("ready\n")
        yield machine
        assert machine.call("faults") == []


def test_enumeration(pico: Emulator) -> None:
    usb = pico.call("usb")
    assert usb["state"] == "configured"
    assert usb["id"] == [0x2E8A, 0x000A]
    assert len(usb["serial"]) == 16
    assert usb["reset_interface"] >= 0


def test_lines_both_ways(pico: Emulator) -> None:
    for line in ("hello", "x" * 63, "y" * 64, "z" * 65, "longer " * 80):
        pico.send(line + "\n")
        assert pico.run_until_text(f"echo {line}\n") == f"echo {line}\n"


def test_an_idle_host_does_not_disturb(pico: Emulator) -> None:
    """NAK does not cost the processor any time: no interrupt in 20 ms without data."""
    pico.run(milliseconds=20)
    pico.call("watch_exceptions", numbers=[USB_INTERRUPT])
    pico.run(milliseconds=20)
    assert pico.call("take", log="exceptions") == []


def test_every_byte_of_a_flood_arrives(pico: Emulator) -> None:
    before = pico.word("received")
    pico.call("usb_flood", text="0123456789abcdef\n")
    pico.run(milliseconds=100)
    pico.call("usb_flood", on=False)
    pico.run(milliseconds=20)
    said = pico.receive()
    count = pico.word("received") - before
    assert count > 5000
    lines = said.split("\n")[:-1]
    assert len(lines) == count // 17
    assert set(lines) == {"echo 0123456789abcdef"}


def test_a_closed_terminal_is_not_read(pico: Emulator) -> None:
    pico.call("usb_open", open=False)
    pico.run(milliseconds=20)
    pico.receive()
    pico.send("nobody reads\n")
    pico.run(milliseconds=50)
    assert (pico.receive(), pico.word("closed")) == ("", 1)
    pico.call("usb_open")
    assert "ready" in pico.run_until_text("ready\n")


def test_the_cable_is_pulled_and_put_back(pico: Emulator) -> None:
    pico.call("usb_flood", text="traffic\n")
    pico.run(milliseconds=5)
    pico.call("usb_detach")
    pico.run(milliseconds=20)
    assert pico.call("usb")["state"] == "detached"
    assert pico.word("closed") == 1
    pico.call("usb_flood", on=False)
    pico.call("usb_attach")
    pico.receive()
    assert "ready" in pico.run_until_text("ready\n", milliseconds=500)
    pico.send("again\n")
    assert "again" in pico.run_until_text("again\n")


def test_a_bus_reset_enumerates_anew(pico: Emulator) -> None:
    pico.call("usb_bus_reset")
    pico.run(milliseconds=100)
    assert pico.call("usb")["state"] == "configured"
    pico.send("back\n")
    assert "echo back" in pico.run_until_text("back\n")


def test_text_is_sent_at_its_cycle(pico: Emulator) -> None:
    at = pico.cycle + 5 * CYCLES_PER_MILLISECOND
    pico.send("later\n", at=at)
    pico.run(until=at)
    assert pico.receive() == ""
    assert "echo later" in pico.run_until_text("later\n", milliseconds=5)


@pytest.mark.parametrize(("request_code", "reason"), [(1, "usb boot"), (2, "end")])
def test_reboot_by_the_reset_interface(pico: Emulator, request_code: int, reason: str) -> None:
    """The requests of ``picotool reboot -f``: into BOOTSEL (1), or into the application (2)."""
    pico.call("usb_control", type=0x21, request=request_code, index=pico.call("usb")["reset_interface"])
    state = pico.run(milliseconds=200)
    if reason == "usb boot":
        assert state["reason"] == "usb boot"
    else:
        assert [reset["cause"] for reset in state["resets"]] == ["watchdog"]
        assert "ready" in pico.run_until_text("ready\n")


def test_runs_repeat(programs: Path) -> None:
    """Two runs with the same seed are equal to the cycle; a run with another seed differs."""

    def cycle_of_answer(seed: int) -> int:
        with Emulator(programs / "serial.elf", usb={"seed": seed, "clock_error": 300, "phase": 123}) as pico:
            pico.run_until_text("ready\n")
            pico.send("time\n")
            pico.run_until_text("time\n")
            return pico.cycle

    assert cycle_of_answer(1) == cycle_of_answer(1)
    assert cycle_of_answer(1) != cycle_of_answer(2)
