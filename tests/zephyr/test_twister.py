"""Drivers, tests and samples as Zephyr's own test runner sees them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from tests.emulator.toolchain import ROOT, arm_gcc, skip_if_missing

from .workspace import NATIVE, run, twister, workspace

FOLDERS = ["tests/zephyr", "zephyr_module/samples"]


def statuses_of(output: Path, *boards: str) -> dict[tuple[str, str], str]:
    """Builds and runs what is for these boards; status by (test, board).  Raises :class:`BuildError`."""
    here = workspace(*boards)
    command = [str(here.python), str(here.base / "scripts" / "twister"), "--jobs", "2", "--outdir", str(output)]
    command += [f"--extra-args=ZEPHYR_MODULES={';'.join(str(module) for module in here.modules)}"]
    for folder in FOLDERS:
        command += ["--testsuite-root", str(ROOT / folder)]
    for board in boards:
        command += ["--platform", board]
    run([*command, "--inline-logs"], here)
    report = json.loads((output / "twister.json").read_text(encoding="utf-8"))
    return {(suite["name"].split("/")[-1], suite["platform"]): suite["status"] for suite in report["testsuites"]}


def test_emulated_decoders(tmp_path: Path) -> None:
    """The sensor API's semantics and the sample, run on native_sim."""
    skip_if_missing(arm_gcc, lambda: twister(workspace(NATIVE)))
    statuses = statuses_of(tmp_path / "twister", NATIVE)
    assert statuses == {
        ("drivers.sensor.epg_qdec.emulated", NATIVE): "passed",
        ("drivers.sensor.epg_qdec.emulated.pm", NATIVE): "passed",
        ("sample.epg.qdec.emulated", NATIVE): "passed",
    }


@pytest.mark.long
def test_boards(tmp_path: Path) -> None:
    """Real boards' builds; a warning is an error."""
    boards = ("rpi_pico", "rpi_pico2/rp2350a/m33", "nucleo_h743zi")
    skip_if_missing(arm_gcc, lambda: twister(workspace(*boards)))
    statuses = statuses_of(tmp_path / "twister", *boards)
    expected = {(test, board) for test in ("drivers.sensor.epg_qdec.build", "sample.epg.qdec") for board in boards}
    assert {key for key, status in statuses.items() if status in ("passed", "not run")} == expected
    assert set(statuses) == expected
