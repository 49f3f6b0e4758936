# SPDX-License-Identifier: Apache-2.0
"""The work for which JIWY's firmware needs most of its stacks, and the bytes that it uses.

All functions of the console, while USB is flooded, unplugged, plugged in and asked for its descriptors; faults and
starts of the model; writes to flash.  The nesting of exceptions depends on the times of packets, hence the seeds.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.closed_loop.board import Board

COMMANDS = (
    "help",
    "ports",
    "stats",
    "get",
    "version",
    "watch",
    "watch inputs.setpoint_pan outputs.pwm_pan",
    "watch off",
    "echo on",
    "echo off",
    "pan_subscriber=0.123456789012345678e-1 tilt_subscriber=0.4",
    r"set Pan\PID\kp=2.2 Tilt\PID\kp=0.99999999999999989 Pan\PID\tauD=4.9406564584124654e-324",
    r"set Pan\PID\kp=2.6 Tilt\PID\kp=1e308",
    "capture inputs.position_pan outputs.pwm_pan",
    "capture",
    "capture read",
    "capture stop",
    "save",
    "jog pwm_pan 0.1 20",
    "nonsense \xff\x00?",
    "=" * 300,
    "enable",
)
PATTERN = (0xE96E96E9).to_bytes(4, "little")
"""The value with which stack.c fills a stack."""
KERNEL_PATTERN = bytes(4 * [0xA5])
"""The value of FreeRTOS: tskSTACK_FILL_BYTE."""
GUARD = 64
"""Bytes at the bottom of core 0's stack that are not filled."""
DEVICE, CONFIGURATION, STRING = 1, 2, 3


@dataclass(frozen=True)
class Stack:
    """Size and use of a stack, in bytes."""

    used: int
    size: int


def worst_of(image: Path, seed: int) -> dict[str, Stack]:
    """The stacks of ``image`` afterwards: "control", "communication", "main" (for interrupts), and the kernel's."""
    draw = random.Random(seed)
    clock = draw.uniform(-500, 500)
    with Board(image, {"pan": 0.12, "tilt": 0.12}, phase=draw.uniform(0, 1000), clock_error=clock) as board:
        pico = board.pico
        board.home()
        _type_everything(board, draw)
        board.ask("disable")
        _type_everything(board, draw)
        pico.call("usb_flood", text="".join(f"{draw.choice(COMMANDS)}\n" for _ in range(400)))
        pico.run(milliseconds=300)
        for command in ("usb_detach", "usb_attach", "usb_bus_reset"):
            pico.call(command)
            pico.run(milliseconds=150 + draw.uniform(0, 5))
        for kind, number in ((DEVICE, 0), (CONFIGURATION, 0), *((STRING, index) for index in range(6))):
            pico.call("usb_descriptor", kind=kind, number=number)
        pico.run(milliseconds=200)
        pico.call("usb_flood", on=False)
        pico.run(milliseconds=600)
        pico.send("\nwatch off\n")
        pico.run(milliseconds=300)
        stats = board.stats()
        assert pico.call("faults") == [] and pico.run(cycles=1)["resets"] == []
        result = {
            name: Stack(int(stats[f"{name}_stack_used"]), int(stats[f"{name}_stack_size"]))
            for name in ("control", "communication")
        }
        bottom, top = (pico.call("symbol", name=name)["address"] for name in ("__StackBottom", "__StackTop"))
        result["main"] = _painted(pico, bottom + GUARD, top, PATTERN)
        for name, symbol in pico.call("symbols", contains="TaskStack").items():
            at, size = symbol["address"], symbol["size"]
            result[name.partition(".")[0]] = _painted(pico, at, at + size, KERNEL_PATTERN)
        return result


def _type_everything(board: Board, draw: random.Random) -> None:
    for command in draw.sample(COMMANDS, len(COMMANDS)):
        board.pico.send(command.encode("latin1") + b"\n")
        board.pico.run(milliseconds=draw.uniform(5, 40))
    board.pico.run(milliseconds=100)
    board.pico.receive()


def _painted(pico: Emulator, bottom: int, top: int, pattern: bytes) -> Stack:
    data = pico.read(bottom, top - bottom)
    used = next(at for at in range(0, len(data), 4) if data[at : at + 4] != pattern)
    return Stack(len(data) - used, len(data))
