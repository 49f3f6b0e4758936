# SPDX-License-Identifier: Apache-2.0
"""Zephyr's own test runner for the module's drivers, tests and samples."""

from __future__ import annotations

import json
from pathlib import Path

from tests.doubles.toolchain import ROOT

from .workspace import c_library, run, workspace

FOLDERS = ["tests/zephyr", "zephyr_module/samples"]


def statuses_of(output: Path, *boards: str) -> dict[tuple[str, str], str]:
    """Builds and runs the tests for these boards; returns the status by (test, board without qualifiers).

    Raises :class:`BuildError`.
    """
    here = workspace(*boards)
    command = [str(here.python), str(here.base / "scripts" / "twister"), "--jobs", "2", "--outdir", str(output)]
    command += [f"--extra-args=ZEPHYR_MODULES={';'.join(str(module) for module in here.modules)}"]
    command += [f"--extra-args={name}={value}" for name, value in c_library().items()]
    for folder in FOLDERS:
        command += ["--testsuite-root", str(ROOT / folder)]
    for board in boards:
        command += ["--platform", board]
    run([*command, "--inline-logs"], here)
    report = json.loads((output / "twister.json").read_text(encoding="utf-8"))
    return {
        (suite["name"].split("/")[-1], suite["platform"].split("/")[0]): suite["status"]
        for suite in report["testsuites"]
    }
