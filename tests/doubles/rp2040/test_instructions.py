# SPDX-License-Identifier: Apache-2.0
"""The emulator's instructions against another emulator: registers and flags after random instructions."""

from __future__ import annotations

import random
from typing import Any

from tests.doubles.toolchain import unicorn

from .conftest import Board

CODE = 0x20020000
DATA = 0x20030000
EDGES = (0, 1, 2, 31, 32, 33, 0x7F, 0xFF, 0x100, 0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFFFE, 0xFFFFFFFF)


def random_value(source: random.Random) -> int:
    return source.choice(EDGES) if source.random() < 0.5 else source.getrandbits(32)


def random_instruction(source: random.Random) -> int:
    """A random 16-bit data-processing instruction of Armv6-M on r0 to r7 (Architecture Reference Manual, A5.2)."""
    group = source.randrange(6)
    if group == 0:  # shift by immediate, add, subtract, move, compare
        return source.randrange(0x0000, 0x4000)
    if group == 1:  # data processing
        return 0x4000 | source.randrange(0x400)
    if group == 2:  # add, compare, move with high registers: r8 to r12 only
        operation = source.choice((0, 1, 2))
        return 0x4400 | operation << 8 | source.randrange(2) << 7 | source.randrange(0, 13) << 3 | source.randrange(5)
    if group == 3:  # extend
        return 0xB200 | source.randrange(0x100)
    if group == 4:  # reverse
        return 0xBA00 | source.choice((0, 1, 3)) << 6 | source.randrange(0x40)
    return 0xA800 | source.randrange(0x800)  # add to SP


def random_access(source: random.Random, registers: list[int]) -> int:
    """A random load or store, after its base register has been set to an address in memory."""
    target, base, offset = source.randrange(8), source.randrange(8), source.randrange(8)
    if source.random() < 0.5:
        operation = source.randrange(8)
        size = (4, 2, 1, 1, 4, 2, 1, 2)[operation]
        if offset == base:
            offset = (base + 1) % 8
        registers[base] = DATA + 64 * size
        registers[offset] = size * source.randrange(-32, 32) % 2**32
        return 0x5000 | operation << 9 | offset << 6 | base << 3 | target
    kind, size = source.choice(((0x6000, 4), (0x7000, 1), (0x8000, 2)))
    registers[base] = DATA + 4 * source.randrange(16)
    return kind | source.randrange(2) << 11 | source.randrange(32) << 6 | base << 3 | target


def reference(module: Any) -> Any:
    arm = module.arm_const
    machine = module.Uc(module.UC_ARCH_ARM, module.UC_MODE_THUMB | module.UC_MODE_MCLASS)
    machine.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M0)
    machine.mem_map(0x20000000, 0x42000 + 0xE000)
    return machine


def run_reference(module: Any, machine: Any, code: bytes, registers: list[int], flags: int) -> tuple[list[int], int]:
    arm = module.arm_const
    numbers = [arm.UC_ARM_REG_R0 + n for n in range(13)] + [arm.UC_ARM_REG_SP]
    for number, value in zip(numbers, registers, strict=True):
        machine.reg_write(number, value)
    machine.reg_write(arm.UC_ARM_REG_APSR, flags << 28)
    machine.mem_write(CODE, code)
    machine.emu_start(CODE | 1, CODE + len(code), count=1)
    after = [machine.reg_read(number) for number in numbers]
    return after, machine.reg_read(arm.UC_ARM_REG_APSR) >> 28


def test_random_instructions(board: Board) -> None:
    module = unicorn()
    machine = reference(module)
    source = random.Random(20402040)
    memory = source.randbytes(1024)
    machine.mem_write(DATA - 512, memory)
    board.pico.call("write", at=DATA - 512, hex=memory.hex())
    runs = []
    for _ in range(20_000):
        registers = [random_value(source) for _ in range(13)] + [0x20031000]
        instruction = random_access(source, registers) if source.random() < 0.2 else random_instruction(source)
        runs.append(
            {"code": instruction.to_bytes(2, "little").hex(), "registers": registers, "flags": source.randrange(16)}
        )
    answers = board.pico.call("execute", at=CODE, runs=runs)
    wrong = []
    for run, (registers, flags, _, fault) in zip(runs, answers, strict=True):
        expected = run_reference(module, machine, bytes.fromhex(run["code"]), run["registers"], run["flags"])
        if fault is not None or (registers, flags) != (expected[0], expected[1]):
            wrong.append((run, registers, flags, fault, expected))
    assert wrong == [], f"{len(wrong)}: {wrong[:3]}"
    after = board.pico.read(DATA - 512, 1024)
    assert after == bytes(machine.mem_read(DATA - 512, 1024))


def test_cycles_of_instructions(board: Board) -> None:
    """Cortex-M0+ Technical Reference Manual, table 3-1, for memory without wait states."""
    expected = {
        "0888": 2,  # ldrh from SRAM
        "1860": 2,  # str to SRAM
        "4243": 1,  # muls: the single-cycle multiplier
        "00bf": 1,  # nop
        "fee7": 2,  # b: taken
        "0fc9": 5,  # ldm r1, four registers
        "f0b4": 5,  # push, four registers
        "f0b5": 6,  # and LR
        "f0bc": 5,  # pop, four registers
        "bff34f8f": 3,  # dsb
        "eff31080": 3,  # mrs
        "00f000f8": 3,  # bl
    }
    registers = [0, DATA, DATA, DATA, 1, 2, 3, 4, 0, 0, 0, 0, 0, 0x20031000]
    cycles = {}
    for code in expected:
        # One instruction per run: only its own two bytes are code, so that a branch to itself also ends after one.
        [[_, _, cycles[code], fault]] = board.pico.call(
            "execute", at=CODE, runs=[{"code": code, "registers": registers, "flags": 0, "once": True}]
        )
        assert fault is None
    assert cycles == expected
