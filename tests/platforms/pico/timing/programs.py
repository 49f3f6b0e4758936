# SPDX-License-Identifier: Apache-2.0
"""The programs whose timing is measured: JIWY's images."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from tests.doubles.rp2040.build import build

PROJECT = "benchmarks/pico"


@dataclass(frozen=True)
class Program:
    """An image of an RP2040 platform that communicates every ``period`` ms: 33, 10 or 1."""

    platform: str
    period: int

    @property
    def title(self) -> str:
        return {"bare_metal": "EPG, bare metal", "freertos": "EPG, FreeRTOS"}[self.platform]

    def image(self) -> Path:
        """Builds the image; SDK, compiler and kernel must be installed."""
        name = f"jiwy_firmware_{self.period}"
        return build(PROJECT, targets=[name], variables={"PLATFORM": self.platform}) / f"{name}.elf"
