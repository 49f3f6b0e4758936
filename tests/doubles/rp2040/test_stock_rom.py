# SPDX-License-Identifier: Apache-2.0
"""A release image, which uses the boot ROM's floating point, runs on a dump of that ROM."""

from __future__ import annotations

import pytest

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing, stock_rom

from .build import build
from .emulator import Emulator


def test_a_stock_image_runs() -> None:
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    if stock_rom() is None:
        pytest.skip("EPG_RP2040_BOOTROM does not name a dump of the RP2040's boot ROM: picotool save -r 0 4000 rom.bin")
    folder = build("tests/doubles/rp2040/programs", targets=["serial"], stock_arithmetic=True)
    with Emulator(folder / "serial.elf", stock=True) as pico:
        pico.run_until_text("ready\n")
        pico.send("hello\n")
        assert pico.run_until_text("hello\n") == "echo hello\n"
        assert pico.call("faults") == []
