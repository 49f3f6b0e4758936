# SPDX-License-Identifier: Apache-2.0
"""``examples/existing_cubemx_repository``: a program in the form of STM32CubeMX's gets a controller by three lines."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.ioc_file import read_ioc
from tests.doubles.toolchain import arm_gcc, skip_if_missing, tool
from tests.examples.pico_project import ROOT, environment

EXAMPLE = ROOT / "examples/existing_cubemx_repository"
BLOCK = re.compile(r"\n# --- the turntable's controller, by EPG ---\n(.*\n.*\n.*\n)# ---\n")
USER_CODE = re.compile(r"( */\* USER CODE BEGIN .* \*/\n)(?:.*\n)*?( */\* USER CODE END .* \*/\n)")


def headers() -> Path:
    return tool("cmsis_device_h7")


def core() -> Path:
    return tool("cmsis_core")


def run(folder: Path, *command: str, check: bool = True) -> str:
    path = f"{arm_gcc()}:{environment()['PATH']}"
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment(PATH=path),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    assert (done.returncode == 0) == check, done.stdout
    return done.stdout


def repository_in(folder: Path) -> Path:
    """The example with the headers that a project of CubeMX has in ``Drivers``."""
    skip_if_missing(arm_gcc, headers, core)
    repository = shutil.copytree(EXAMPLE, folder / "repository", ignore=shutil.ignore_patterns("build", "Drivers"))
    device = repository / "Drivers/CMSIS/Device/ST/STM32H7xx/Include"
    shutil.copytree(headers() / "Include", device)
    shutil.copytree(core() / "CMSIS/Core/Include", repository / "Drivers/CMSIS/Include")
    return repository


def configure(repository: Path, check: bool = True) -> str:
    return run(
        repository,
        "cmake",
        "--preset",
        "Release",
        f"-DEPG_PATH={ROOT}",
        f"-DPython3_EXECUTABLE={sys.executable}",
        check=check,
    )


def symbols(elf: Path) -> dict[str, int]:
    text = run(elf.parent, "arm-none-eabi-nm", "--defined-only", str(elf))
    return {name: int(address, 16) for address, _, name in (line.split() for line in text.splitlines())}


def masking_functions(elf: Path) -> set[str]:
    """The functions that delay the tick: PRIMASK and FAULTMASK mask it, BASEPRI does not."""
    text = run(elf.parent, "arm-none-eabi-objdump", "-d", str(elf))
    functions = re.split(r"^[0-9a-f]+ <(\w+)>:$", text, flags=re.M)[1:]
    sets = re.compile(r"\bcpsid\b|\bmsr\s+(?:PRIMASK|FAULTMASK)")
    return {name for name, code in zip(functions[::2], functions[1::2]) if sets.search(code)}


def test_the_readme_shows_the_three_lines() -> None:
    added = BLOCK.search((EXAMPLE / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert added
    lines = added[1].splitlines()
    assert len(lines) == 3
    readme = (EXAMPLE / "README.md").read_text(encoding="utf-8")
    assert "".join(f"+{line}\n" for line in lines) in readme


def test_the_import_file_is_epgs() -> None:
    assert (EXAMPLE / "epg_import.cmake").read_bytes() == (ROOT / "cmake/epg_import.cmake").read_bytes()


def test_the_project_file_is_the_programs() -> None:
    """Pins, priorities and baud rate in station.ioc are those that the program's code sets up."""
    ioc = read_ioc(EXAMPLE / "station.ioc", Diagnostics())
    assert ioc is not None
    code = (EXAMPLE / "Core/Src/main.c").read_text(encoding="utf-8")
    assert ioc.value("PB0.Signal") == "GPIO_Output" and ioc.value("PC13.Signal") == "GPXTI13"
    assert ioc.value("PD8.Signal") == "USART3_TX" and "MODE8_1" in code
    assert "NVIC_SetPriority(SysTick_IRQn, 15)" in code and "NVIC_SetPriority(EXTI15_10_IRQn, 5)" in code
    assert ioc.value("NVIC.SysTick_IRQn").startswith("true:15:")
    assert ioc.value("NVIC.EXTI15_10_IRQn").startswith("true:5:")
    frequency = int(ioc.value("RCC.USART234578Freq_Value"))
    assert f"USART3->BRR = {round(frequency / int(ioc.value('USART3.BaudRate')))};" in code


def test_the_program_gains_the_controller(tmp_path: Path) -> None:
    """It is built without and with the three lines: no handler, no start-up code and no script of it changes."""
    repository = repository_in(tmp_path)
    lists, main = repository / "CMakeLists.txt", repository / "Core/Src/main.c"
    with_epg, with_calls = lists.read_text(), main.read_text()
    lists.write_text(BLOCK.sub("\n", with_epg))
    main.write_text(USER_CODE.sub(r"\1\2", with_calls))
    configure(repository)
    output = run(repository, "cmake", "--build", "--preset", "Release")
    assert "warning" not in output
    before = symbols(repository / "build/Release/station.elf")
    assert not any(name.startswith("epg_") for name in before)

    lists.write_text(with_epg)
    main.write_text(with_calls)
    output = run(repository, "cmake", "--build", "--preset", "Release")
    assert "warning" not in output
    after = symbols(repository / "build/Release/station.elf")
    handlers = {name for name in before if name.endswith("Handler")}
    assert len(handlers) > 100
    assert {name for name in after if name.endswith("Handler")} == handlers, "EPG defines no handler"
    default = after["Default_Handler"]
    own = re.findall(r"^void (\w+_(?:IRQ)?Handler)\(void\);", (EXAMPLE / "Core/Inc/stm32h7xx_it.h").read_text(), re.M)
    assert len(own) == 10 and all(after[name] != default for name in own)
    assert {"turntable_start", "epg_stm32_start"} <= set(after)
    assert after["_estack"] - after["epg_stm32_stack_bottom"] == after["_Min_Stack_Size"] == 0x800
    assert 0x24000000 <= after["_sbss"] < 0x24080000
    for buffer in ("receive_buffers", "send_buffers"):  # whole lines of the cache, where the DMA reaches them
        assert after["_sbss"] <= after[buffer] < after["_ebss"] and after[buffer] % 32 == 0
    assert masking_functions(repository / "build/Release/station.elf") == {"epg_sectors_read"}

    # A program that reaches into the sectors of the store is not linked.
    begin, large = "/* USER CODE BEGIN 2 */", "static const volatile char large[0x1C0000] = {1};\n"
    main.write_text(large + with_calls.replace(begin, f"{begin}\n    (void)large[0];"))
    output = run(repository, "cmake", "--build", "--preset", "Release", check=False)
    assert "EPG: the program reaches into the last two sectors of the flash" in output


def test_missing_headers_are_named_together(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty cache, first without ``Drivers/CMSIS``, then with it."""
    repository = repository_in(tmp_path)
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    drivers = (repository / "Drivers").rename(tmp_path / "Drivers")
    output = configure(repository, check=False)
    assert output.count("CMake Error") == 1
    assert "CMSIS_5.git" in output and "cmsis-device-h7.git" in output
    drivers.rename(repository / "Drivers")
    configure(repository)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("PB0.Signal=GPIO_Output", "PD12.Signal=GPIO_Output"), "pin PD12 is used by other code of the program"),
        (("Mcu.IP5=USART3", "Mcu.IP5=TIM4"), "'encoder' needs timer TIM4, which other code of the program uses"),
        (("Mcu.UserName=STM32H743ZITx", "Mcu.UserName=STM32F767ZITx"), "this project is for the chip STM32F767ZITx"),
    ],
)
def test_a_conflict_with_the_program_stops_cmake(change: tuple[str, str], message: str, tmp_path: Path) -> None:
    repository = repository_in(tmp_path)
    file = repository / "station.ioc"
    text = file.read_text()
    assert change[0] in text
    file.write_text(text.replace(*change))
    output = configure(repository, check=False)
    assert f"error: {message}" in output
    line = file.read_text().splitlines().index(change[1]) + 1
    assert f"station.ioc:{line}:" in output and "turntable.tcf:" in output


def test_the_program_is_checked_again_when_cubemx_writes_its_project(tmp_path: Path) -> None:
    repository = repository_in(tmp_path)
    configure(repository)
    file = repository / "station.ioc"
    streams = "Dma.SPI1_RX.0.Instance=DMA1_Stream7\nDma.SPI1_TX.1.Instance=DMA2_Stream0\n"
    priority = "NVIC.EXTI15_10_IRQn=true\\:0"
    file.write_text(streams + file.read_text().replace("NVIC.EXTI15_10_IRQn=true\\:5", priority))
    output = configure(repository)
    assert "warning: interrupt EXTI15_10 has the preemption priority 0" in output
    (generated,) = (repository / "build").rglob("turntable_stm32.c")
    assert ".other_streams = 0u | 1u << 7 | 1u << 8," in generated.read_text(encoding="utf-8")
