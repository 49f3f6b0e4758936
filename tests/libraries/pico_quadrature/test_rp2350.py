# SPDX-License-Identifier: Apache-2.0
"""RP2350: both variants build without a warning; an emulated Cortex-M33 runs the checks of the configuration.

There is no emulator of its PIO, but the programs use only instructions that the RP2040 has, too.
"""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.toolchain import arm_gcc, pico_sdk, skip_if_missing, unicorn

from .conftest import BLOCK, OK, PINS, PROJECT, PULL, STATE_MACHINE

RETURN = 0x20080000
CONFIG = 0x20070000
STATE = 0x20070100


@pytest.fixture(scope="module")
def image() -> Path:
    """The build treats EPG's warnings as errors."""
    skip_if_missing(pico_sdk, arm_gcc)
    return build(PROJECT, board="pico2", targets=["encoders"]) / "encoders.elf"


def symbols(image: Path) -> dict[str, int]:
    program = arm_gcc().parent / "arm-none-eabi-nm"
    listing = subprocess.run([program, str(image)], capture_output=True, text=True, check=True).stdout
    return {line.split()[2]: int(line.split()[0], 16) for line in listing.splitlines() if len(line.split()) == 3}


def flash_content(image: Path) -> bytes:
    binary = image.with_suffix(".flash")
    program = arm_gcc().parent / "arm-none-eabi-objcopy"
    subprocess.run([program, "-O", "binary", str(image), str(binary)], check=True)
    return binary.read_bytes()


class Processor:
    """A Cortex-M33 with the image's flash and RAM; peripherals are memory with SET and CLR aliases."""

    def __init__(self, image: Path) -> None:
        self.module: Any = unicorn()
        arm = self.module.arm_const
        self.cpu = self.module.Uc(self.module.UC_ARCH_ARM, self.module.UC_MODE_THUMB | self.module.UC_MODE_MCLASS)
        self.cpu.ctl_set_cpu_model(arm.UC_CPU_ARM_CORTEX_M33)
        binary = flash_content(image)
        self.cpu.mem_map(0x10000000, 0x400000)
        self.cpu.mem_write(0x10000000, binary)
        self.cpu.mem_map(0x20000000, 0x82000)
        self.cpu.mem_map(0xD0000000, 0x1000)
        self.registers: dict[int, int] = {}
        self.cpu.mmio_map(0x40000000, 0x10800000, self._read, None, self._write, None)
        self.names = symbols(image)
        # RAM as after the start-up code: .data copied from flash.
        start, end, source = (self.names[name] for name in ("__data_start__", "__data_end__", "__etext"))
        self.cpu.mem_write(start, binary[source - 0x10000000 : source - 0x10000000 + end - start])
        for pin in range(48):
            self.registers[0x40028000 + 8 * pin + 4] = 0x1F  # no function, as after a reset
            self.registers[0x40038004 + 4 * pin] = 0x116  # isolated, pull-down

    def _read(self, _: Any, offset: int, size: int, __: Any) -> int:
        address = (0x40000000 + offset) & ~0x3000
        return self.registers.get(address & ~3, 0) >> 8 * (address & 3) & (1 << 8 * size) - 1

    def _write(self, _: Any, offset: int, size: int, value: int, __: Any) -> None:
        address = 0x40000000 + offset
        operation, address = address >> 12 & 3, address & ~0x3000
        before = self.registers.get(address, 0)
        after = {0: value, 1: before ^ value, 2: before | value, 3: before & ~value}[operation]
        self.registers[address] = after & 0xFFFFFFFF

    def init(self, config: list[int]) -> int:
        """Calls ``epg_pico_quadrature_init()``; returns its error."""
        arm = self.module.arm_const
        self.cpu.mem_write(CONFIG, bytes(config))
        for register, value in (
            (arm.UC_ARM_REG_SP, 0x20081000),
            (arm.UC_ARM_REG_LR, RETURN | 1),
            (arm.UC_ARM_REG_R0, STATE),
            (arm.UC_ARM_REG_R1, CONFIG),
        ):
            self.cpu.reg_write(register, value)
        self.cpu.emu_start(self.names["epg_pico_quadrature_init"] | 1, RETURN, count=100_000)
        assert self.cpu.reg_read(arm.UC_ARM_REG_PC) == RETURN
        return int(self.cpu.reg_read(arm.UC_ARM_REG_R0)) & 0xFF


# pin A, pin B, block, state machine, variant, pull, invert
@pytest.mark.parametrize(
    ("config", "error"),
    [
        ([10, 11, 0, 0, 0, 2, 0], PULL),
        ([10, 11, 0, 0, 0, 1, 0], OK),
        ([10, 11, 2, 3, 1, 0, 0], OK),
        ([11, 10, 2, 0xFF, 0, 0, 1], OK),
        ([10, 11, 3, 0, 0, 0, 0], BLOCK),
        ([31, 32, 0, 0, 0, 0, 0], PINS),
        ([10, 12, 0, 0, 0, 0, 0], PINS),
        ([10, 11, 0, 4, 0, 0, 0], STATE_MACHINE),
    ],
)
def test_what_rp2350_takes_and_refuses(image: Path, config: list[int], error: int) -> None:
    """A pull-down is refused (erratum RP2350-E9); there is a third block; a Pico 2 has 30 pins."""
    skip_if_missing(unicorn)
    processor = Processor(image)
    assert processor.init(config) == error
    if error == OK:
        block, pull = config[2], config[5]
        for pin in config[:2]:
            assert processor.registers[0x40028000 + 8 * pin + 4] & 0x1F == 6 + block  # function PIO0, PIO1, PIO2
            pad = processor.registers[0x40038004 + 4 * pin]
            assert pad & 0x100 == 0  # not isolated
            assert pad & 0x40 != 0  # input enabled
            assert (pad >> 3 & 1, pad >> 2 & 1) == (int(pull == 1), 0)
        assert processor.registers[0x50200000 + 0x100000 * block] & 0xF != 0  # CTRL: a state machine runs
