# SPDX-License-Identifier: Apache-2.0
"""The programs of ``mps2``, for the processors that QEMU emulates."""

from __future__ import annotations

from functools import partial
from pathlib import Path

from tests.doubles.mps2.qemu import qemu
from tests.doubles.toolchain import skip_if_missing, tool

from .builds import HERE, PROCESSORS, build

MACHINES = {"m3": "mps2-an385", "m7": "mps2-an500"}
"""QEMU's machine for each processor."""

PORTS = {"m3": "ARM_CM3", "m7": "ARM_CM7/r0p1"}
"""The port of FreeRTOS for each processor."""

COUNTERS = {"m3": (32, 32), "m7": (64, 16)}
"""Bits of the counters of pan and tilt."""


def image(processor: str, program: str) -> Path:
    """A program of ``mps2`` for one of these processors."""
    skip_if_missing(
        qemu,
        lambda: PROCESSORS[processor].tool("gcc"),
        *(partial(tool, name) for name in ("freertos_kernel", "micro_xrce_dds_client", "micro_cdr")),
    )
    settings = {"FREERTOS": str(tool("freertos_kernel")), "FREERTOS_PORT": PORTS[processor]}
    settings["COUNTERS"] = ";".join(map(str, COUNTERS[processor]))
    return build(PROCESSORS[processor], HERE / "mps2", **settings) / program
