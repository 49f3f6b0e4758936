# SPDX-License-Identifier: Apache-2.0
"""The targets that a new project can have: their proposed names, and the tools that are missing for them."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from epg.connect.configurations import Configurations
from epg.connect.creation import proposal


@pytest.fixture
def bare(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A computer with a C compiler and CMake, and without any SDK."""
    for name in list(os.environ):
        if name.endswith(("_PATH", "_BASE")):
            monkeypatch.delenv(name)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))


def test_tools_of_the_middleware_and_of_the_chip_can_be_missing(bare: None) -> None:
    entries = {entry["name"]: set(entry["missing"]) for entry in Configurations(()).entries(None, None)}
    client = {"Micro XRCE-DDS client", "Micro-CDR"}
    assert entries["rpi_pico_freertos_jiwy"] >= {"Raspberry Pi Pico SDK", "FreeRTOS kernel", *client}
    assert entries["nucleo_h743zi_freertos_jiwy"] >= {"FreeRTOS kernel", "ST's headers of STM32H7", *client}
    assert entries["rpi_pico_bare_metal"] >= {"Raspberry Pi Pico SDK", *client}, "a new project gets a middleware"
    assert not entries["host_jiwy"] & client


@pytest.mark.parametrize(
    ("folder", "name"), [("pico_export", "pico_robot"), ("arm_export", "arm"), ("math_export", "math_robot")]
)
def test_every_target_can_have_the_proposed_name(folder: str, name: str, tmp_path: Path) -> None:
    (tmp_path / folder).mkdir()
    assert proposal(tmp_path / folder, Configurations(()).catalog)["name"] == name
