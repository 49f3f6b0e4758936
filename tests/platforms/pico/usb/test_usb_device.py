# SPDX-License-Identifier: Apache-2.0
"""The USB device with one and with two serial ports: descriptors, both ports at once, picotool's interface."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing
from tests.doubles.usb_descriptors import (
    BOS,
    CONFIGURATION,
    PICOTOOL_RESET,
    STRING,
    DescriptorError,
    interfaces,
    serial_ports,
    text,
)

ONE_PORT = """
    09025400030100807d
    080b000202020000
    0904000001020200 04 0524002001 0524010001 04240206 0524060001 07058103080010
    09040100020a000000 07050202400000 07058202400000
    0904020000ff000105
"""
"""Interfaces 0 and 1 are the port, 2 is picotool's.  udev rules and drivers may depend on these numbers."""


@pytest.fixture(scope="module")
def folder() -> Path:
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    return build("tests/platforms/pico/usb/project", targets=["echo_1", "echo_2"])


@pytest.fixture
def one(folder: Path) -> Iterator[Emulator]:
    yield from device(folder / "echo_1.elf")


@pytest.fixture
def two(folder: Path) -> Iterator[Emulator]:
    yield from device(folder / "echo_2.elf")


def device(image: Path) -> Iterator[Emulator]:
    with Emulator(image, usb={"seed": 5}) as pico:
        assert pico.run(milliseconds=1000, configured=True)["usb"] == "configured"
        pico.run(milliseconds=5)
        yield pico
        assert pico.call("faults") == []


def descriptor(pico: Emulator, kind: int, number: int = 0) -> bytes:
    index = 0x409 if kind == STRING else 0
    return bytes.fromhex(pico.call("usb_descriptor", kind=kind, number=number, index=index))


def ask(pico: Emulator, said: str, port: int) -> str:
    pico.send(said, port=port)
    return pico.run_until_text("\n", port=port)


def test_one_port_is_as_it_was(one: Emulator) -> None:
    configuration = descriptor(one, CONFIGURATION)
    assert configuration.hex() == "".join(ONE_PORT.split())
    (port,) = serial_ports(configuration)
    assert text(descriptor(one, STRING, port.text)) == "EPG ROS 2"
    assert ask(one, "hello\n", 0) == "1:hello\n"


def test_two_ports_and_the_reset_interface(two: Emulator) -> None:
    configuration = descriptor(two, CONFIGURATION)
    first, second = serial_ports(configuration)
    assert (first.control, second.control) == (0, 2), "if00 and if02 in /dev/serial/by-id"
    assert text(descriptor(two, STRING, first.text)) == "EPG ROS 2"
    assert text(descriptor(two, STRING, second.text)) == "EPG console"
    (reset,) = [interface for interface in interfaces(configuration) if interface.kind == PICOTOOL_RESET]
    assert (reset.number, reset.endpoints) == (4, ())
    assert text(descriptor(two, STRING, reset.text)) == "Reset"
    usb = two.call("usb")
    assert re.fullmatch("[0-9A-F]{16}", usb["serial"])
    assert usb["id"] == [0x2E8A, 0x000A], "Pico SDK CDC UART, docs/pico.md"
    assert [text(descriptor(two, STRING, number)) for number in (1, 2)] == ["Raspberry Pi", "Pico"]


@pytest.mark.parametrize("ports", [1, 2])
def test_windows_finds_the_driver_of_the_reset_interface(folder: Path, ports: int) -> None:
    for pico in device(folder / f"echo_{ports}.elf"):
        objects = descriptor(pico, BOS)
        assert bytes.fromhex("df60ddd88945c74c9cd2659d9e648a9f") in objects, "Microsoft OS 2.0"
        request = objects[-2]
        data = bytes.fromhex(pico.call("usb_descriptor", kind=0, type=0xC0, request=request, index=7))
        assert len(data) == int.from_bytes(data[8:10], "little")
        subset = data[10:18]
        assert subset[4] == pico.call("usb")["reset_interface"] == 2 * ports
        assert b"WINUSB" in data


def test_both_ports_echo(two: Emulator) -> None:
    assert ask(two, "hello\n", 0) == "1:hello\n"
    assert ask(two, "hello\n", 1) == "2:hello\n"
    for number in range(20):
        two.send(f"a{number}\n", port=0)
        two.send(f"b{number}\n", port=1)
    two.run(milliseconds=100)
    assert two.receive(port=0) == "".join(f"1:a{number}\n" for number in range(20))
    assert two.receive(port=1) == "".join(f"2:b{number}\n" for number in range(20))


def test_a_flooded_port_leaves_the_other_alone(two: Emulator) -> None:
    two.call("usb_flood", text="0123456789abcdef\n", port=0)
    for number in range(5):
        assert ask(two, f"b{number}\n", 1) == f"2:b{number}\n"
    two.call("usb_flood", on=False, port=0)
    two.run(milliseconds=20)
    said = two.receive(port=0)
    assert said.count("\n") > 20
    assert set(said.splitlines()) == {"1:0123456789abcdef"}


def test_a_port_that_nobody_has_opened(two: Emulator) -> None:
    """The other port works, and a program that opens this one later does not receive old bytes."""
    two.call("usb_open", open=False, port=0)
    two.run(milliseconds=5)
    two.send("lost\n", port=0)
    assert ask(two, "hello\n", 1) == "2:hello\n"
    two.run(milliseconds=20)
    two.call("usb_open", port=0)
    two.run(milliseconds=20)
    assert ask(two, "new\n", 0).endswith("1:new\n")
    assert ask(two, "hello\n", 1) == "2:hello\n"


def test_picotool_reboots_the_device_with_two_ports(two: Emulator) -> None:
    two.call("usb_control", type=0x21, request=0x02, index=4)
    state = two.run(milliseconds=300)
    assert [reset["cause"] for reset in state["resets"]] == ["watchdog"]
    two.run(milliseconds=1000, configured=True)
    two.run(milliseconds=5)
    assert ask(two, "again\n", 1) == "2:again\n"


@pytest.mark.parametrize(
    ("position", "value", "reason"),
    [
        (2, 0x4C, "another length"),
        (4, 4, "4 interfaces are stated"),
        (11, 1, "not associated"),
        (43, 2, "union"),
        (46, 0x02, "endpoints"),
    ],
)
def test_the_checker_finds_what_is_wrong(position: int, value: int, reason: str) -> None:
    data = bytearray.fromhex(ONE_PORT)
    data[position] = value
    with pytest.raises(DescriptorError, match=re.escape(reason)):
        serial_ports(bytes(data))
