# SPDX-License-Identifier: Apache-2.0
"""No code that the control cycle can reach is in flash, even in a user's executable that runs from flash.

The RP2040 emulator finds accesses that happen (test_loop.py); the call graph finds possible accesses, on both chips.
"""

from __future__ import annotations

import re

import pytest

from tests.platforms.pico.call_graph import FLASH, RAM, Image
from tests.platforms.pico.images import TARGETS, binutils, images, skip_unless_buildable

CYCLE = ("on_wrap", "application")
"""The handler of the tick, and the table of the generated functions that it calls."""

NOT_IN_A_CYCLE = frozenset({"start", "__wrap_panic", "__wrap___assert_func", "__wrap__exit"})
"""Functions in those tables that run before the first cycle or after the last."""


@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_no_code_and_no_table_of_the_cycle_is_in_flash(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, "user_jiwy") / "user_jiwy.elf")
    ways = image.reachable(*CYCLE, stop=NOT_IN_A_CYCLE)
    assert {"epg_control_cycle", "jiwy_model_step", "epg_exchange_write", "jiwy_pwm_pan_config"} <= {
        symbol.name for symbol in ways
    }, "the graph has the cycle's functions and tables"
    assert [" < ".join(reversed(way)) for symbol, way in ways.items() if symbol.address in FLASH] == []


@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_the_rest_of_a_users_executable_stays_in_flash(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, "user_jiwy") / "user_jiwy.elf")
    assert image.named("main").address in FLASH


def test_the_graph_finds_what_is_in_flash() -> None:
    skip_unless_buildable("bare_metal")
    image = Image(images("pico2", "bare_metal", "user_jiwy") / "user_jiwy.elf")
    found = {symbol.name for symbol in image.reachable("application") if symbol.address in FLASH}
    assert {"epg_port_pwm_start", "epg_pico_quadrature_init", "pio_add_program_at_offset"} <= found


@pytest.mark.parametrize(("board", "platform"), TARGETS)
def test_epgs_own_executables_run_from_ram(board: str, platform: str) -> None:
    skip_unless_buildable(platform)
    image = Image(images(board, platform, "jiwy_firmware") / "jiwy_firmware.elf")
    assert image.named("main").address in RAM
    assert image.named("on_wrap").address in RAM


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
