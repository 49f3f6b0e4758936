# SPDX-License-Identifier: Apache-2.0
"""Programs that EPG builds for Nucleo boards: warnings, places in memory, no heap."""

from __future__ import annotations

import pytest

from tests.doubles.stm32.image import Image
from tests.platforms.pico.compiled import own_sources, problems
from tests.platforms.stm32.images import PLATFORMS, images

H743, F767 = "nucleo_h743zi", "nucleo_f767zi"
BUILDS = [(H743, platform, middleware) for platform in PLATFORMS for middleware in ("console", "xrce")]
BUILDS += [(F767, platform, "console") for platform in PLATFORMS]
ITCM, DTCM, AXI, SRAM1, BANK_1 = (
    range(0x20, 0x10000),
    range(0x20000000, 0x20020000),
    range(0x24000000, 0x24080000),
    range(0x30000000, 0x30020000),
    range(0x08000000, 0x08100000),
)
PLACES = {
    "epg_one_core_on_tick": ITCM,
    "epg_control_cycle": ITCM,
    "jiwy_model_step": ITCM,
    "epg_port_pwm_write": ITCM,
    "epg_port_quadrature_count": ITCM,
    "epg_stm32_enter": ITCM,
    "memcpy": ITCM,
    "jiwy_target": DTCM,
    "jiwy_control": DTCM,
    "epg_stm32_hardware": DTCM,
    "epg_one_core_control_memory": DTCM,
    "epg_one_core_emergency_stack": DTCM,
    "vectors": DTCM,
    "decoders": DTCM,
    "epg_stm32_stack_bottom": DTCM,
    "epg_mcu_service_memory": AXI,
    "send_buffers": SRAM1,
    "receive_buffers": SRAM1,
    "epg_start_vectors": BANK_1,
    "Reset_Handler": BANK_1,
    "epg_port_uart_send": BANK_1,
    "epg_stm32_image_end": BANK_1,
}
OF_F767 = {
    ITCM: range(0x20020000, 0x20030000),
    AXI: range(0x20030000, 0x2007C000),
    SRAM1: range(0x2007C000, 0x20080000),
}
"""The STM32F767 has code of the cycle and data of the communication in SRAM1, buffers of the DMA in SRAM2."""


@pytest.mark.parametrize(("board", "platform", "middleware"), BUILDS)
def test_parts_are_in_their_memories(board: str, platform: str, middleware: str) -> None:
    symbols = Image(images(platform, middleware, board) / "jiwy_firmware.elf").symbols
    places = PLACES if platform == "bare_metal" else {k: v for k, v in PLACES.items() if k != "epg_mcu_service_memory"}
    if board == F767:
        places = {name: OF_F767.get(memory, memory) for name, memory in places.items()}
        places |= dict.fromkeys(("wait_for_flash", "erase", "program_word", "epg_stm32_time_us"), OF_F767[ITCM])
    assert {name: hex(symbols[name]) for name, memory in places.items() if symbols[name] not in memory} == {}
    assert symbols["epg_start_vectors"] == 0x08000000
    assert symbols["epg_stm32_stack_bottom"] == DTCM.start, "below the stack is no memory"
    assert {"malloc", "_malloc_r", "calloc", "free", "_sbrk"} & set(symbols) == set()


@pytest.mark.parametrize(("board", "platform", "middleware"), BUILDS)
def test_epgs_c_has_no_warning(board: str, platform: str, middleware: str) -> None:
    sources = own_sources(images(platform, middleware, board))
    assert {
        "start.c",
        "flash.c",
        "reset.c",
        "timers.c",
        "uarts.c",
        "clocks.c",
        "uart.c",
        "jiwy_app.c",
        "jiwy_stm32.c",
        "cplusplus.c",
        *(("zi2_app.c", "zi2_stm32.c") if board == H743 else ()),
    } <= {file.name for file in sources}
    assert {file.name: said for file, command in sources.items() if (said := problems(command))} == {}
