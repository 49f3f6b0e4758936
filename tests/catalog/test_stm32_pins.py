# SPDX-License-Identifier: Apache-2.0
"""The pins of the STM32 chips in ``targets/socs`` are those of ST's own table, row by row.

ST publishes the table as https://github.com/STMicroelectronics/STM32_open_pin_data (BSD-3-Clause).  The test needs a
checkout of the commit below in EPG's cache, or in the folder that ``EPG_STM32_OPEN_PIN_DATA`` names::

    git clone https://github.com/STMicroelectronics/STM32_open_pin_data
    git -C STM32_open_pin_data checkout 3d64b1076ac7f0bf0f74acf89b9578b530f37ed7    # STM32CubeMX 6.15.0
"""

from __future__ import annotations

import os
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.catalog import load_catalog
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics

COMMIT = "3d64b1076ac7f0bf0f74acf89b9578b530f37ed7"
XML = {"": "http://dummy.com"}  # the namespace that ST's files have
PIN = re.compile(r"P[A-K]\d+")
SIGNAL = re.compile(r"(TIM\d+)_(CH\d)|(US?ART\d+)_([TR]X)|(USB_OTG_FS)_(D[MP])")
"""Signals that EPG's table has: neither complementary outputs (``TIM1_CH1N``) nor LPUART1."""

Row = tuple[str, str, str, int]
"""Instance, slot, pin, number of the alternate function."""


def checkout() -> Path:
    named = os.environ.get("EPG_STM32_OPEN_PIN_DATA")
    folder = Path(named) if named else cache_folder() / f"STM32_open_pin_data-{COMMIT}"
    if not (folder / "mcu").is_dir():
        pytest.skip("EPG_STM32_OPEN_PIN_DATA does not name a checkout of ST's STM32_open_pin_data")
    return folder


def rows_of_st(mcu: str) -> tuple[set[Row], set[str]]:
    """All rows of ST's table for a chip, and its pins."""
    folder = checkout() / "mcu"
    chip = ElementTree.parse(folder / f"{mcu}.xml").getroot()
    (version,) = (ip.attrib["Version"] for ip in chip.findall("IP", XML) if ip.attrib["Name"] == "GPIO")
    numbers = {
        (pin.attrib["Name"], signal.attrib["Name"]): value.text or ""
        for pin in ElementTree.parse(folder / "IP" / f"GPIO-{version}_Modes.xml").getroot().findall("GPIO_Pin", XML)
        for signal in pin.findall("PinSignal", XML)
        for value in signal.findall("SpecificParameter[@Name='GPIO_AF']/PossibleValue", XML)
    }
    rows, pins = set(), set()
    for pin in chip.findall("Pin", XML):
        written = pin.attrib["Name"]  # PA0, PC14-OSC32_IN, PC2_C
        name = PIN.match(written)
        if name is None:
            continue
        pins.add(name[0])
        for signal in pin.findall("Signal", XML):
            found = SIGNAL.fullmatch(signal.attrib["Name"])
            if found is not None:
                function = re.fullmatch(r"GPIO_AF(\d+)_\w+", numbers[written, found[0]])
                assert function is not None
                instance, slot = (part for part in found.groups() if part is not None)
                rows.add((instance, slot, name[0], int(function[1])))
    return rows, pins


@pytest.mark.parametrize(
    ("name", "mcu"),
    [("nucleo_h743zi_bare_metal", "STM32H743ZITx"), ("nucleo_f767zi_bare_metal", "STM32F767ZITx")],
)
def test_pins_and_alternate_functions_are_those_of_st(name: str, mcu: str) -> None:
    target = load_catalog(targets_roots(), Diagnostics()).find_target(name)
    assert target is not None
    ours = {
        (peripheral.instances[instance], peripheral.slots[slot], pin, peripheral.functions[instance, slot][pin])
        for peripheral in target.soc.peripherals.values()
        for (instance, slot), pins in peripheral.pins.items()
        for pin in pins
    }
    rows, pins = rows_of_st(mcu)
    assert len(rows) > 90
    assert sorted(ours - rows) == [] and sorted(rows - ours) == []
    assert set(target.soc.pins) == pins
