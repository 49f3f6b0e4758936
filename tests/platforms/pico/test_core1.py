# SPDX-License-Identifier: Apache-2.0
"""A program that uses core 1 itself: neither the program nor the control loop takes the core from the other."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.doubles.rp2040.emulator import Emulator
from tests.platforms.pico.images import images, skip_unless_emulated

START, STOP, LAUNCH, LAUNCH_WITH_STACK, RESET = range(1, 6)
OK, TAKEN = 0, 7
"""The values of EPG_PICO_OK and EPG_PICO_ERROR_CORE_TAKEN."""
REFUSED, DONE, RETURNED = 0, 1, 2
"""The results of start and stop; the SDK's functions do not return a result."""


@pytest.fixture
def pico() -> Iterator[Emulator]:
    skip_unless_emulated("bare_metal")
    with Emulator(images("pico", "bare_metal", "user_core1") / "user_core1.elf") as emulator:
        emulator.run_until("main", core=0)
        yield emulator
        assert emulator.call("faults") == []
        assert emulator.run(cycles=1)["resets"] == []


def obey(pico: Emulator, order: int) -> int:
    pico.write_word("answer", -1)
    pico.write_word("order", order)
    pico.run(milliseconds=10)
    return pico.word("answer", signed=True)


def counts(pico: Emulator) -> bool:
    """True if the program's own code runs on core 1."""
    before = pico.word("turns")
    pico.run(milliseconds=1)
    return pico.word("turns") != before


def controls(pico: Emulator) -> bool:
    """True if the control loop runs."""
    before = pico.word("status", offset=16)
    pico.run(milliseconds=5)
    return pico.word("status", offset=16) > before


@pytest.mark.parametrize("launch", [LAUNCH, LAUNCH_WITH_STACK])
def test_a_target_does_not_start_while_the_program_has_core_1(pico: Emulator, launch: int) -> None:
    assert obey(pico, launch) == RETURNED
    assert counts(pico)
    assert obey(pico, START) == REFUSED
    assert pico.word("error") == TAKEN
    assert counts(pico), "the program goes on"
    assert obey(pico, RESET) == RETURNED
    assert obey(pico, START) == DONE
    assert pico.word("error") == OK
    assert controls(pico) and not counts(pico)


@pytest.mark.parametrize("order", [LAUNCH, LAUNCH_WITH_STACK, RESET])
def test_a_program_does_not_get_core_1_while_a_target_runs(pico: Emulator, order: int) -> None:
    assert obey(pico, START) == DONE
    assert obey(pico, order) == RETURNED
    assert pico.word("error") == TAKEN
    assert controls(pico) and not counts(pico)
    assert obey(pico, STOP) == DONE
    assert obey(pico, LAUNCH) == RETURNED
    assert counts(pico), "core 1 is the program's again"
