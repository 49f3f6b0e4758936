# SPDX-License-Identifier: Apache-2.0
"""The code that all families share does not depend on a chip: it compiles for a fictitious family and runs here."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

from tests.doubles.toolchain import ROOT, arm_gcc, skip_if_missing, tool
from tests.platforms.pico.compiled import STRICT
from tests.runtime.program import RUNTIME, compile_program, run_program

HERE = Path(__file__).resolve().parent
PLATFORMS = ROOT / "targets" / "platforms"
MCU = ROOT / "targets" / "mcu"
SHARED = [MCU, PLATFORMS / "bare_metal", PLATFORMS / "freertos"]
INCLUDES = [HERE / "family" / "include", MCU / "include", PLATFORMS / "freertos" / "include", RUNTIME / "include"]
CORES = ["cortex-m0plus", "cortex-m33", "cortex-m4", "cortex-m7"]


def test_no_file_of_theirs_names_a_chip() -> None:
    files = [path for folder in SHARED for path in folder.rglob("*") if path.is_file()]
    assert len(files) > 12
    code = {path.name: re.sub(r"/\*.*?\*/", "", path.read_text(encoding="utf-8"), flags=re.DOTALL) for path in files}
    assert [name for name, text in code.items() if re.search("pico|rp2", text, re.IGNORECASE)] == []


@pytest.mark.parametrize("processor", CORES)
def test_bare_metal_compiles_for_other_cores(processor: str) -> None:
    skip_if_missing(arm_gcc)
    compile_only(processor, [*(MCU / "src").glob("*.c"), *(PLATFORMS / "bare_metal" / "src").glob("*.c")])


def test_freertos_compiles_for_a_cortex_m7() -> None:
    skip_if_missing(arm_gcc, kernel)
    folders = [kernel() / "include", kernel() / "portable" / "GCC" / "ARM_CM7" / "r0p1"]
    folders += [PLATFORMS / "freertos" / "config", HERE / "family" / "freertos" / "include"]
    sources = [*(MCU / "src").glob("*.c"), *(PLATFORMS / "freertos" / "src").glob("*.c")]
    compile_only("cortex-m7", sources, *(f"-I{folder}" for folder in folders), "-mfpu=fpv5-d16", "-mfloat-abi=hard")


def test_control_on_one_core_compiles_for_a_cortex_m3(tmp_path: Path) -> None:
    """QEMU runs it on a Cortex-M4F and on a Cortex-M7: tests/platforms/one_core."""
    skip_if_missing(arm_gcc, core)
    one_core = MCU / "one_core"
    family = ROOT / "tests" / "doubles" / "mps2" / "targets" / "families" / "mps2"
    (tmp_path / "epg_mps2_target.h").write_text("#define EPG_MPS2_MIDDLEWARE_STACK 2048\n", encoding="utf-8")
    folders = [tmp_path, family / "include", one_core / "include"]
    options = [*(f"-I{folder}" for folder in folders), "-isystem", str(core() / "CMSIS" / "Core" / "Include")]
    sources = [*(one_core / "src").glob("*.c"), *(one_core / "bare_metal").glob("*.c")]
    compile_only("cortex-m3", sources, *options, includes=INCLUDES[1:])


def test_freertos_takes_a_configuration_of_stm32cubemx(tmp_path: Path) -> None:
    skip_if_missing(arm_gcc, kernel)
    config = tmp_path / "FreeRTOSConfig.h"
    folders = [tmp_path, kernel() / "include", kernel() / "portable" / "GCC" / "ARM_CM4F"]
    options = [*(f"-I{folder}" for folder in folders), "-mfpu=fpv5-d16", "-mfloat-abi=hard"]
    sources = [*(MCU / "src").glob("*.c"), PLATFORMS / "freertos" / "src" / "service.c"]
    config.write_text(CUBEMX, encoding="utf-8")
    compile_only("cortex-m7", sources, *options)
    config.write_text(CUBEMX.replace("1000)", "100)"), encoding="utf-8")
    with pytest.raises(AssertionError, match=r"FreeRTOSConfig\.h: #define configTICK_RATE_HZ 1000"):
        compile_only("cortex-m7", sources, *options)


CUBEMX = """
#include <stdint.h>
extern uint32_t SystemCoreClock;
#define configENABLE_FPU                         0
#define configENABLE_MPU                         0
#define configUSE_PREEMPTION                     1
#define configSUPPORT_STATIC_ALLOCATION          1
#define configSUPPORT_DYNAMIC_ALLOCATION         1
#define configUSE_IDLE_HOOK                      0
#define configUSE_TICK_HOOK                      0
#define configCPU_CLOCK_HZ                       ( SystemCoreClock )
#define configTICK_RATE_HZ                       ((TickType_t)1000)
#define configMAX_PRIORITIES                     ( 56 )
#define configMINIMAL_STACK_SIZE                 ((uint16_t)128)
#define configTOTAL_HEAP_SIZE                    ((size_t)15360)
#define configMAX_TASK_NAME_LEN                  ( 16 )
#define configUSE_TRACE_FACILITY                 1
#define configUSE_16_BIT_TICKS                   0
#define configUSE_MUTEXES                        1
#define configUSE_RECURSIVE_MUTEXES              1
#define configUSE_COUNTING_SEMAPHORES            1
#define configUSE_PORT_OPTIMISED_TASK_SELECTION  0
#define configUSE_TIMERS                         1
#define configTIMER_TASK_PRIORITY                ( 2 )
#define configTIMER_QUEUE_LENGTH                 10
#define configTIMER_TASK_STACK_DEPTH             256
#define INCLUDE_vTaskPrioritySet             1
#define INCLUDE_uxTaskPriorityGet            1
#define INCLUDE_vTaskDelete                  1
#define INCLUDE_vTaskSuspend                 1
#define INCLUDE_vTaskDelay                   1
#define INCLUDE_xTaskGetSchedulerState       1
#define INCLUDE_xTimerPendFunctionCall       1
#define INCLUDE_xQueueGetMutexHolder         1
#define INCLUDE_uxTaskGetStackHighWaterMark  1
#define INCLUDE_xTaskGetCurrentTaskHandle    1
#define INCLUDE_eTaskGetState                1
#define configPRIO_BITS                      4
#define configLIBRARY_LOWEST_INTERRUPT_PRIORITY 15
#define configLIBRARY_MAX_SYSCALL_INTERRUPT_PRIORITY 5
#define configKERNEL_INTERRUPT_PRIORITY ( configLIBRARY_LOWEST_INTERRUPT_PRIORITY << (8 - configPRIO_BITS) )
#define configMAX_SYSCALL_INTERRUPT_PRIORITY ( configLIBRARY_MAX_SYSCALL_INTERRUPT_PRIORITY << (8 - configPRIO_BITS) )
#define configASSERT( x ) if ((x) == 0) {taskDISABLE_INTERRUPTS(); for( ;; );}
#define vPortSVCHandler    SVC_Handler
#define xPortPendSVHandler PendSV_Handler
"""
"""As STM32CubeMX writes it for an STM32H7 with CMSIS-RTOS 2, without its comments."""


def test_the_store_and_the_ticks(tmp_path: Path) -> None:
    sources = [HERE / "store.c", MCU / "src" / "store.c"]
    done = run_program([compile_program(tmp_path / "store", sources, includes=INCLUDES)])
    assert done.returncode == 0, done.stdout + done.stderr


def kernel() -> Path:
    return tool("freertos_kernel")


def core() -> Path:
    return tool("cmsis_core")


def compile_only(processor: str, sources: list[Path], *options: str, includes: Sequence[Path] = INCLUDES) -> None:
    assert len(sources) >= 4
    for source in sources:
        command = [str(arm_gcc()), "-std=gnu11", f"-mcpu={processor}", "-mthumb", "-O2", "-c", "-o", "/dev/null"]
        command += [*STRICT, *(f"-I{folder}" for folder in includes), *options, "-DEPG_MCU_START=robot_start"]
        done = subprocess.run([*command, str(source)], capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
