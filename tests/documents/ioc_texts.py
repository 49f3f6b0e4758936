# SPDX-License-Identifier: Apache-2.0
"""Makes project files of STM32CubeMX (``.ioc``) for tests, as CubeMX writes them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

ORDINARY: Mapping[str, str] = {
    "CAD.formats": "",
    "File.Version": "6",
    "GPIO.groupedBy": "Group By Peripherals",
    "Mcu.Family": "STM32H7",
    "Mcu.Package": "LQFP144",
    "Mcu.Pin0": "PC14-OSC32_IN (OSC32_IN)",
    "MxCube.Version": "6.12.0",
    "PA13 (JTMS/SWDIO).Mode": "Serial_Wire",
    "PA13 (JTMS/SWDIO).Signal": "DEBUG_JTMS-SWDIO",
    "PC14-OSC32_IN (OSC32_IN).Signal": "RCC_OSC32_IN",
    "PH0-OSC_IN (PH0).Signal": "RCC_OSC_IN",
    "ADC1.Channel-3#ChannelRegularConversion": "ADC_CHANNEL_9",
    "NVIC.HardFault_IRQn": "true:0:0:false:false:true:true:false:false",
    "NVIC.SysTick_IRQn": "true:15:0:false:false:true:true:true:false",
    "ProjectManager.functionlistsort": "1-SystemClock_Config-RCC-false-HAL-false,2-MX_GPIO_Init-GPIO-false-HAL-true",
    "RCC.CpuClockFreq_Value": "400000000",
    "VP_SYS_VS_Systick.Signal": "SYS_VS_Systick",
}
"""Entries that every project has, and that concern none of EPG's pins."""


def ioc_text(
    entries: Mapping[str, str] | None = None,
    peripherals: Sequence[str] = (),
    pins: Mapping[str, str] | None = None,
    chip: str = "STM32H743ZITx",
) -> str:
    """The text of a project for ``chip`` that sets up ``peripherals`` and has signals on ``pins``."""
    listed = {f"Mcu.IP{number}": name for number, name in enumerate(("NVIC", "RCC", "SYS", *peripherals))}
    signals = {f"{pin}.Signal": signal for pin, signal in (pins or {}).items()}
    names = {"Mcu.Name": chip, "Mcu.UserName": chip}
    every = {**ORDINARY, **names, **listed, **signals, **(entries or {})}
    lines = [f"{escaped(key, ' #=:!')}={escaped(value, '#=:!')}" for key, value in sorted(every.items())]
    return "\n".join(["#MicroXplorer Configuration settings - do not modify", *lines]) + "\n"


def escaped(text: str, special: str) -> str:
    """``text`` as ``java.util.Properties.store`` writes it; spaces at the beginning of a value are escaped, too."""
    names = {"\t": "\\t", "\n": "\\n", "\r": "\\r", "\f": "\\f", "\\": "\\\\"}
    result = ""
    for number, char in enumerate(text):
        leading = char == " " and number == 0
        if char in names:
            result += names[char]
        elif char in special or leading:
            result += "\\" + char
        elif not " " <= char <= "~":
            data = char.encode("utf-16-be", "surrogatepass")
            result += "".join(f"\\u{data[at]:02X}{data[at + 1]:02X}" for at in range(0, len(data), 2))
        else:
            result += char
    return result
