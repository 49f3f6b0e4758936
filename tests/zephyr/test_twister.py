# SPDX-License-Identifier: Apache-2.0
"""Drivers, sample and a whole target on native_sim, with Zephyr's own test runner."""

from __future__ import annotations

from pathlib import Path

from tests.doubles.toolchain import arm_gcc, skip_if_missing

from .twister import statuses_of
from .workspace import NATIVE, c_library, need_twister, workspace


def test_native_sim(tmp_path: Path) -> None:
    """The behaviour of the drivers, the sample, and JIWY's target, which test_qemu.py also uses."""
    skip_if_missing(arm_gcc, lambda: need_twister(workspace(NATIVE)), c_library)
    statuses = statuses_of(tmp_path / "twister", NATIVE)
    assert statuses == {
        ("drivers.pwm.epg_emulated", "native_sim"): "passed",
        ("drivers.sensor.epg_qdec.emulated", "native_sim"): "passed",
        ("drivers.sensor.epg_qdec.emulated.pm", "native_sim"): "passed",
        ("epg.jiwy.emulated", "native_sim"): "passed",
        ("epg.store", "native_sim"): "passed",
        ("sample.epg.qdec.emulated", "native_sim"): "passed",
    }
