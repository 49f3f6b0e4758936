# SPDX-License-Identifier: Apache-2.0
"""The example's application on an emulated Pico, enabled at start: JIWY on its pins, agent and console on USB."""

from __future__ import annotations

from collections import Counter
from functools import partial
from pathlib import Path

from tests.doubles.toolchain import arm_gcc, node, rp2040js, skip_if_missing, xrce_libraries
from tests.platforms.pico.closed_loop.robot import WRAP_EXCEPTION
from tests.platforms.pico.xrce.board import Jiwy
from tests.zephyr.workspace import build, c_library, workspace

APPLICATION = "tests/zephyr/proof/application"
SPANS = {
    "tick": ("on_wrap", "epg_zephyr_watchdog_feed"),
    "cycle": ("epg_control_cycle", "return"),
    "read": ("epg_qdec_get_count", "return"),
    "write": ("epg_port_pwm_write", "return"),
    "locked": ("write_actuators", "return"),
}
"""From the tick's interrupt, which reads the encoders, to the end of the cycle in the control thread."""


def skip_unless_emulated() -> None:
    skip_if_missing(partial(workspace, "rpi_pico"), arm_gcc, c_library, node, rp2040js)
    skip_if_missing(xrce_libraries)


def image() -> Path:
    return build(APPLICATION, "rpi_pico", settings=c_library()) / "zephyr" / "zephyr.elf"


class ZephyrJiwy(Jiwy):
    """The board after its start, connected to its agent; one core runs control, communication and USB."""

    core = 0
    spans = SPANS

    def __init__(self, seed: int = 3, elf: Path | None = None) -> None:
        super().__init__("zephyr", seed=seed, elf=elf or image())
        self.pico.call("watch_exceptions", numbers=[WRAP_EXCEPTION])

    def begin(self) -> None:
        super().begin()
        self.interrupts()
        self.cycles()
        self.locked()

    def cycles(self) -> list[int]:
        """The times at which control cycles began in their thread, since the last call."""
        return [cycle for cycle, *_ in self.pico.call("span", name="cycle")["passages"]]

    def locked(self) -> list[int]:
        """Processor cycles for which each write locked interrupts, since the last call."""
        return [length for _, length, _ in self.pico.call("span", name="locked")["passages"]]

    def interrupts(self) -> list[int]:
        """The times at which the tick's interrupt was entered, since the last call."""
        return [cycle for cycle, _, _, entered in self.pico.call("take", log="exceptions") if entered]


def deviations(instants: list[int], period: int) -> Counter[int]:
    """Delays of instants from the earliest grid with that period, in their unit, and how often each occurs."""
    zero = min(instant - number * period for number, instant in enumerate(instants))
    return Counter(instant - zero - number * period for number, instant in enumerate(instants))
