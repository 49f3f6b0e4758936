# SPDX-License-Identifier: Apache-2.0
"""The example builds for both boards, and does what its README promises."""

from __future__ import annotations

import pytest

from tests.doubles.rp2040.build import build
from tests.doubles.rp2040.emulator import Emulator
from tests.doubles.toolchain import arm_gcc, node, pico_sdk, rp2040js, skip_if_missing

EXAMPLE = "examples/pico_quadrature"


@pytest.mark.parametrize("board", ["pico", "pico2"])
def test_it_builds(board: str) -> None:
    skip_if_missing(pico_sdk, arm_gcc)
    assert (build(EXAMPLE, board=board) / "quadrature.elf").is_file()


def test_it_prints_positions_and_resets_them() -> None:
    skip_if_missing(pico_sdk, arm_gcc, node, rp2040js)
    with Emulator(build(EXAMPLE) / "quadrature.elf") as pico:
        for name, pin in (("pan", 10), ("tilt", 12)):
            pico.call("encoder", name=name, a=pin, b=pin + 1)
        pico.run_until_text("pan 0 tilt 0\r\n", milliseconds=400)
        for name, steps in (("pan", 5), ("tilt", 3)):
            edges = [[pico.cycle + 1000 * k + 1000, 1] for k in range(steps)]
            pico.call("move", name=name, kind="schedule", edges=edges)
        pico.run_until_text("pan 5 tilt -3\r\n", milliseconds=300)
        pico.send("reset\n")
        pico.run_until_text("pan 0 tilt 0\r\n", milliseconds=300)
        assert pico.call("faults") == []
