# SPDX-License-Identifier: Apache-2.0
"""PIO blocks that run late and skip idle cycles give exactly the results of a run cycle by cycle."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing

from .build import build
from .emulator import Emulator


@pytest.fixture(scope="session")
def encoders() -> Path:
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    return build("tests/libraries/pico_quadrature/program", targets=["encoders"]) / "encoders.elf"


def trace(image: Path, *, lockstep: bool, variant: int, shortest: int) -> list[list[int]]:
    """Every write of the program to its results, with cycle and value, while four encoders turn."""
    with Emulator(image) as pico:
        pico.run_until("main")
        for n in range(4):
            a, b = 2 * n + 4, 2 * n + 5
            pico.call("encoder", name=str(n), a=a, b=b)
            for k, value in enumerate((a, b, n // 2, n % 2, variant)):
                pico.write_word("parameters", value, offset=32 * n + 4 * k)
        pico.write_word("count", 4)
        pico.write_word("request", 1)
        pico.run(cycles=20_000)
        if lockstep:
            pico.call("pio_lockstep")
        pico.call("watch_memory", at="positions")
        pico.write_word("request", 3)
        for n in range(4):
            pico.call("move", name=str(n), kind="random", seed=n + 9, shortest=shortest, longest=300, burst=40)
        pico.run(milliseconds=0.8)
        writes: list[list[int]] = pico.call("take", log="writes")
        return writes


@pytest.mark.parametrize("variant", [0, 1], ids=["count", "velocity"])
@pytest.mark.parametrize("shortest", [3, 9])
def test_leaps_change_nothing(encoders: Path, variant: int, shortest: int) -> None:
    leaping = trace(encoders, lockstep=False, variant=variant, shortest=shortest)
    stepping = trace(encoders, lockstep=True, variant=variant, shortest=shortest)
    assert len(leaping) > 20
    assert leaping == stepping
