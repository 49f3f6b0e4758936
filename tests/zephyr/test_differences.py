# SPDX-License-Identifier: Apache-2.0
"""Settings of a user's prj.conf and overlay that contradict the target are reported before the compiler starts."""

from __future__ import annotations

import re
from functools import partial

import pytest

from tests.doubles.toolchain import arm_gcc, skip_if_missing

from .workspace import BuildError, build, workspace

BOARD = "nucleo_h743zi"
EXPECTED = {
    "CONFIG_SENSOR is n, and the target needs y",
    "the devicetree's &timers1 has st,prescaler = <9999>, and components.pwm_pan needs <0>",
    "the devicetree's &timers1 has st,prescaler = <9999>, and components.pwm_tilt needs <0>",
    "the devicetree's &usart3 has current-speed = <9600>, and components.line needs <115200>",
    "the devicetree has no node with the label qdec0, which components.encoder_pan names",
    "the console is on usart3, which carries a middleware's bytes: write CONFIG_UART_CONSOLE=n in prj.conf, or choose"
    " another zephyr,console in an overlay",
}


def test_all_differences_are_reported_at_once() -> None:
    skip_if_missing(partial(workspace, BOARD), arm_gcc)
    with pytest.raises(BuildError) as said:
        build("tests/zephyr/differences", BOARD)
    text = re.sub(r"\s+", " ", str(said.value))
    text = text.partition("what the target needs is not what Zephyr is configured to:")[2].partition("Take what says")[
        0
    ]
    missing = [message for message in EXPECTED if message not in text]
    assert missing == [], text
