# SPDX-License-Identifier: Apache-2.0
"""A program on core 0 sets and gets values by name, beside a console on USB and the control loop on core 1."""

from __future__ import annotations

import struct
from collections.abc import Iterator

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import binutils
from tests.platforms.pico.images import images, skip_unless_emulated

INPUTS = ("position_pan", "position_tilt", "setpoint_pan", "setpoint_tilt")
KP = "Pan\\PID\\kp"


@pytest.fixture(scope="module")
def pico() -> Iterator[Emulator]:
    skip_unless_emulated("bare_metal")
    image = images("pico", "bare_metal", "user_access", middleware="console") / "user_access.elf"
    with Emulator(image, usb={"seed": 5}) as emulator:
        assert emulator.run(milliseconds=1000, configured=True)["usb"] == "configured"
        emulator.run(milliseconds=20)
        yield emulator
        assert emulator.call("faults") == []
        assert emulator.word("refused") == 0
        assert emulator.word("disordered") == 0


def number(pico: Emulator, place: str, offset: int = 0) -> float:
    value: float = struct.unpack("<d", pico.read(place, 8, offset=offset))[0]
    return value


def setpoint(pico: Emulator) -> float:
    """The model's input in the values of one cycle: a time, then the inputs."""
    return number(pico, "values", 8 + 8 * INPUTS.index("setpoint_pan"))


def ask(pico: Emulator, line: str) -> str:
    pico.receive()
    pico.send(f"{line}\n")
    return pico.run_until_text(f"ok {line.split()[0].split('=')[0]}", milliseconds=200)


def test_setpoints_of_the_program_and_of_messages(pico: Emulator) -> None:
    pico.write_word("wanted", 250)
    pico.run(milliseconds=5)
    assert setpoint(pico) == 0.25
    pico.write_word("wanted", -1)
    pico.run(milliseconds=5)
    pico.send("pan_subscriber=0.75\n")
    pico.run(milliseconds=20)
    assert setpoint(pico) == 0.75
    pico.write_word("wanted", 1250)
    pico.run(milliseconds=5)
    assert setpoint(pico) == 1.25


def test_parameters_of_the_program_and_of_the_console(pico: Emulator) -> None:
    assert number(pico, "measured_gain") == 2.6
    pico.write_word("gain", 1500)
    pico.run(milliseconds=5)
    assert number(pico, "measured_gain") == 1.5
    assert f"parameter {KP}=1.5 generated=2.6" in ask(pico, f"get {KP}")
    pico.write_word("gain", -1)
    pico.run(milliseconds=5)
    ask(pico, f"set {KP}=2")
    pico.run(milliseconds=5)
    assert number(pico, "measured_gain") == 2.0


def test_the_cycle_reads_no_flash(pico: Emulator) -> None:
    pico.write_word("wanted", 500)
    pico.write_word("gain", 1250)
    pico.call("watch_span", name="cycle", core=1, **{"from": "on_wrap", "to": "return"})
    pico.run(milliseconds=50)
    span = pico.call("span", name="cycle")
    assert len(span["passages"]) >= 48
    assert span["flash_total"] == 0, span["flash"][:10]


def test_after_a_stop_and_a_start(pico: Emulator) -> None:
    pico.write_word("wanted", -1)
    pico.run(milliseconds=5)
    failed = pico.word("first_failed")
    pico.write_word("order", 1)
    pico.run(milliseconds=30)
    assert pico.word("first_failed") == failed + 1
    assert pico.word("rounds") > 10
    assert setpoint(pico) == 0.0
    pico.write_word("wanted", 100)
    pico.run(milliseconds=5)
    assert setpoint(pico) == 0.1


def test_a_program_that_calls_nothing_contains_nothing() -> None:
    skip_unless_emulated("bare_metal")
    elf = images("pico", "bare_metal", "user_jiwy", middleware="console") / "user_jiwy.elf"
    names = {line.split()[-1] for line in binutils("nm", str(elf)).splitlines()}
    assert "jiwy_inputs" in names and "jiwy_outputs" in names, "for debuggers"
    assert not {name for name in names if "access" in name or name.startswith(("jiwy_get", "jiwy_set"))}
