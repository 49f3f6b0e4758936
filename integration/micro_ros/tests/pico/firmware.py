# SPDX-License-Identifier: Apache-2.0
"""JIWY's firmware with the middleware ``micro_ros``, for FreeRTOS on a Pico, built with the user's libmicroros."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from tests.doubles.rp2040.build import build
from tests.platforms.pico.images import PROJECT, skip_unless_buildable, skip_unless_emulated
from tests.platforms.pico.xrce.board import Jiwy

VARIABLE = "EPG_TEST_MICRO_ROS_PICO"
"""Variable that names that library.  MICRO_ROS_PATH is the library for this computer."""
FIRMWARE = "jiwy_firmware"


def library() -> str:
    """The user's libmicroros for Cortex-M0+; skips the test if it is missing."""
    folder = os.environ.get(VARIABLE)
    if not folder:
        pytest.skip(f"{VARIABLE} does not name a libmicroros for Cortex-M0+: its README says what one has")
    return folder


def firmware(board: str = "pico", executable: str = FIRMWARE) -> Path:
    skip_unless_buildable("freertos")
    variables = {"PLATFORM": "freertos", "MIDDLEWARE": "micro_ros", "MICRO_ROS_PATH": library()}
    return build(PROJECT, board=board, targets=[executable], variables=variables) / f"{executable}.elf"


class MicroRosJiwy(Jiwy):
    """A Pico like that with ``xrce``: the same agent, the same topics."""

    def __init__(self, seed: int = 3, executable: str = FIRMWARE) -> None:
        library()
        skip_unless_emulated("freertos")
        super().__init__("freertos", seed=seed, elf=firmware(executable=executable))
