"""Drivers, sample and a whole target on emulated boards, as Zephyr's own test runner sees them."""

from __future__ import annotations

import shutil
from pathlib import Path

from tests.emulator.toolchain import Missing, arm_gcc, skip_if_missing

from .twister import statuses_of
from .workspace import NATIVE, c_library, need_twister, workspace

QEMU = "mps2/an385"


def qemu() -> None:
    if not shutil.which("qemu-system-arm"):
        raise Missing("qemu-system-arm is not installed: apt install qemu-system-arm")


def test_emulated_boards(tmp_path: Path) -> None:
    """The drivers' semantics and the sample on native_sim; JIWY's target there and on a Cortex-M3 in QEMU."""
    skip_if_missing(arm_gcc, c_library, qemu, lambda: need_twister(workspace(NATIVE)))
    statuses = statuses_of(tmp_path / "twister", NATIVE, QEMU)
    assert statuses == {
        ("drivers.pwm.epg_emulated", "native_sim"): "passed",
        ("drivers.sensor.epg_qdec.emulated", "native_sim"): "passed",
        ("drivers.sensor.epg_qdec.emulated.pm", "native_sim"): "passed",
        ("epg.jiwy.emulated", "mps2"): "passed",
        ("epg.jiwy.emulated", "native_sim"): "passed",
        ("sample.epg.qdec.emulated", "native_sim"): "passed",
    }
