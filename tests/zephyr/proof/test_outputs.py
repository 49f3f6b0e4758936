# SPDX-License-Identifier: Apache-2.0
"""PWM levels act at the same wrap after each tick, also in images with other addresses of code and other clocks."""

from __future__ import annotations

import random

import pytest

from tests.platforms.pico.xrce.board import AGENT_PORT, CONSOLE_PORT
from tests.zephyr.workspace import build, c_library

from .board import APPLICATION, ZephyrJiwy, skip_unless_emulated
from .checks import LATEST_WRITE

SECONDS = 20
IMAGES: dict[str, dict[str, str]] = {
    "shipped": {},
    "fast": {"CONFIG_SPEED_OPTIMIZATIONS": "y"},
    "coarse_ticks": {"CONFIG_SYS_CLOCK_TICKS_PER_SEC": "10000"},
}


@pytest.mark.parametrize("flooded", [False, True], ids=["agent", "flooded"])
@pytest.mark.parametrize("image", IMAGES)
def test_all_act_at_the_same_wrap(image: str, flooded: bool) -> None:
    skip_unless_emulated()
    elf = build(APPLICATION, "rpi_pico", settings={**c_library(), **IMAGES[image]}) / "zephyr" / "zephyr.elf"
    draw = random.Random(11)
    with ZephyrJiwy(seed=11, elf=elf) as jiwy:
        jiwy.home()
        jiwy.begin()
        if flooded:
            for port in (AGENT_PORT, CONSOLE_PORT):
                jiwy.pico.call("usb_flood", seed=port + 1, port=port)
        end = jiwy.agent.now() + SECONDS
        while jiwy.agent.now() < end:
            jiwy.point(draw.uniform(0.1, 1.2), draw.uniform(0.1, 1.2))
            jiwy.agent.run(33 * draw.uniform(0.98, 1.02))
        timing = jiwy.timing()
    assert timing.cycles > 1000 * SECONDS - 2
    assert timing.missed == 0
    assert set(timing.actuation) == {0}
    assert max(timing.written) < LATEST_WRITE
