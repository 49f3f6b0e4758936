# SPDX-License-Identifier: Apache-2.0
"""A decoder that the hardware cannot do is an error of the build with a clear message; `mistakes` has one of each."""

from __future__ import annotations

import re
from functools import partial

import pytest

from tests.doubles.toolchain import arm_gcc, skip_if_missing

from .workspace import BuildError, build, workspace

EXPECTED = {
    "rpi_pico2/rp2350a/m33": {
        "A and B of an epg,pico-pio-qdec must be adjacent pins",
        "a PIO block has four state machines, for at most four decoders",
        "counts-per-revolution must be 1 or more",
        "inputs of RP2350 must not have bias-pull-down (erratum RP2350-E9)",
        "the function of pins in ab_pins must be that of the decoder's PIO block",
        "the group ab_pins must have two pins: A, then B",
        "the group ab_pins must have input-enable",
    },
    "nucleo_h743zi": {
        "epg,stm32-qdec must be a child of a timer (st,stm32-timers)",
        "the timer of an epg,stm32-qdec must not have another function",
        "the timer of an epg,stm32-qdec has no encoder mode",
        "the timer of an epg,stm32-qdec has no interrupts",
        "the timer of an epg,stm32-qdec is not enabled: status = okay",
        "the timer of an epg,stm32-qdec must have four channels",
    },
}


DRIVERS = {"rpi_pico2/rp2350a/m33": "qdec_pico_pio.c", "nucleo_h743zi": "qdec_stm32.c"}


@pytest.mark.parametrize("board", EXPECTED)
def test_mistakes_have_messages(board: str) -> None:
    skip_if_missing(partial(workspace, board), arm_gcc)
    with pytest.raises(BuildError) as said:
        build("tests/zephyr/mistakes", board, only=DRIVERS[board])
    messages = re.findall(r'error: static assertion failed: "(.*)"$', str(said.value), re.MULTILINE)
    assert {message.replace("\\'", "'").replace('\\"', "") for message in messages} == EXPECTED[board]
