# SPDX-License-Identifier: Apache-2.0
"""``program`` on a board in QEMU: the line of its agent, its console, and orders from the test.

>>> # with OneCore("mps2_an500", "freertos") as board:
>>> #     board.let_pass(100).missed        # 0
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

from tests.doubles.mps2.qemu import qemu
from tests.doubles.toolchain import skip_if_missing, tool
from tests.platforms.firmware.builds import PROCESSORS, build
from tests.platforms.firmware.free_running import FreeRunning

HERE = Path(__file__).resolve().parent
TARGETS = HERE.parents[1] / "doubles" / "mps2" / "targets"
BOARDS = {"mps2_an386": "m4f", "mps2_an500": "m7"}
"""The processor of each board."""
ORDERS = 2
"""The UART of the test."""


@dataclass(frozen=True)
class State:
    """An answer to an order; ``program/orders.c`` has the table of orders."""

    time_us: int
    cycles: int
    missed: int
    overruns: int
    enabled: int
    fault: int
    lateness_max: int
    driven: int
    """motors that are driven"""
    sums: int
    wrong_sums: int
    timer1_calls: int
    systick_calls: int
    error: int
    priority: int
    """number of the interrupt that EPG has reported, plus 16"""
    control_stack: int
    service_stack: int
    within: int
    """control cycles within the newest time in which interrupts were masked or late"""
    faults: int
    """calls of the program's HardFault handler since power-on"""
    driven_in_fault: int
    turns: int
    """of the communication side"""
    result: int


def image(board: str, platform: str, controller: str = "jiwy", **settings: str) -> Path:
    """The program; compiled once per version of its sources."""
    needs = ("freertos_kernel", "micro_xrce_dds_client", "micro_cdr", "cmsis_core")
    processor = PROCESSORS[BOARDS[board]]
    skip_if_missing(qemu, lambda: processor.tool("gcc"), *(lambda name=name: tool(name) for name in needs))
    with mock.patch.dict(os.environ, {"EPG_TARGETS_PATH": str(TARGETS)}):
        folder = build(processor, HERE / "program", BOARD=board, PLATFORM=platform, CONTROLLER=controller, **settings)
    return folder / "program"


class OneCore(FreeRunning):
    """A board that runs, with a test at its lines."""

    LINES = ("agent", "console", "orders")
    STATE = State

    def __init__(self, board: str, platform: str, controller: str = "jiwy", **settings: str) -> None:
        super().__init__(board.replace("_", "-"), image(board, platform, controller, **settings))
