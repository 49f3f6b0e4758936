# SPDX-License-Identifier: Apache-2.0
"""No code that the control cycle can reach is in flash, although executables run from flash.

The RP2040 emulator finds accesses that happen (test_loop.py); the call graph finds possible accesses, on both chips.
"""

from __future__ import annotations

import re

import pytest

from tests.doubles.toolchain import binutils
from tests.platforms.pico.call_graph import FLASH, RAM, Image, Symbol
from tests.platforms.pico.images import TARGETS, images, skip_unless_buildable

CYCLE = ("on_wrap", "application", "sleep_between_ticks", "on_hard_fault")
"""The handler of the tick, the table of the generated functions that it calls, the wait between ticks, and faults."""

NOT_IN_A_CYCLE = frozenset({"start", "__wrap_panic", "__wrap___assert_func", "__wrap__exit"})
"""Functions in those tables that run before the first cycle or after the last."""


@pytest.mark.parametrize("executable", ["user_jiwy", "jiwy_firmware"])
@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_no_code_and_no_table_of_the_cycle_is_in_flash(board: str, platform: str, executable: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, executable) / f"{executable}.elf")
    ways = image.reachable(*CYCLE, stop=NOT_IN_A_CYCLE)
    expected = {"epg_control_cycle", "jiwy_model_step", "epg_exchange_write", "jiwy_pwm_pan_config"}
    assert expected | {"epg_pico_safe_state"} <= {symbol.name for symbol in ways}, "the cycle's functions and tables"
    assert in_flash(ways) == []


@pytest.mark.parametrize("board", ["pico", "pico2"])
def test_no_function_of_mathematics_is_in_flash(board: str) -> None:
    """The SDK's own arithmetic, with each function that a model can call."""
    skip_unless_buildable("bare_metal")
    image = Image(images(board, "bare_metal", "user_bench", stock_arithmetic=True) / "user_bench.elf")
    ways = image.reachable(*CYCLE, stop=NOT_IN_A_CYCLE)
    assert {"__wrap_sin", "__wrap_pow", "__wrap_floor", "__wrap_fmod"} <= {symbol.name for symbol in ways}
    assert in_flash(ways) == []


def in_flash(ways: dict[Symbol, tuple[str, ...]]) -> list[str]:
    return [" < ".join(reversed(way)) for symbol, way in ways.items() if symbol.address in FLASH]


@pytest.mark.parametrize("executable", ["user_jiwy", "jiwy_firmware"])
@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_the_rest_of_an_executable_stays_in_flash(board: str, platform: str, executable: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, executable) / f"{executable}.elf")
    assert image.named("main").address in FLASH
    assert image.named("epg_pico_start").address in FLASH


@pytest.mark.parametrize(("board", "platform"), [("pico", "bare_metal"), ("pico2", "freertos")])
def test_an_executable_runs_from_ram_if_the_user_wants(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, "jiwy_in_ram") / "jiwy_in_ram.elf")
    assert image.named("main").address in RAM
    assert image.named("on_wrap").address in RAM
    assert image.named("epg_pico_start").address in RAM


def test_the_graph_finds_what_is_in_flash() -> None:
    skip_unless_buildable("bare_metal")
    image = Image(images("pico2", "bare_metal", "user_jiwy") / "user_jiwy.elf")
    found = {symbol.name for symbol in image.reachable("application") if symbol.address in FLASH}
    assert {"epg_port_pwm_start", "epg_pico_quadrature_init", "pio_add_program_at_offset"} <= found


@pytest.mark.parametrize("board", ["pico", "pico2"])
def test_barriers_of_the_exchange_are_in_the_machine_code(board: str) -> None:
    """Sequentially consistent accesses: on each core a `dmb`, or a load-acquire and store-release, per access."""
    skip_unless_buildable("bare_metal")
    elf = images(board, "bare_metal", "jiwy_firmware") / "jiwy_firmware.elf"
    code = binutils("objdump", "-d", "--no-show-raw-insn", "--disassemble=epg_exchange_write", str(elf))
    ordered = re.findall(r"\t(dmb|lda|stl)\b", code)
    # Six accesses: reading and slot are loaded; slot, latest and writes are stored (and writes is loaded once more).
    assert len(ordered) >= 6, code
    # The value is copied before `slot` announces it: a call or a loop, then an ordered store.
    copied = max(code.find("memcpy"), 0)
    assert re.search(r"\t(dmb|stl)\b", code[copied:]), code
