# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

from .program import PROGRAMS, Program, compile_program, platform_sources


@pytest.fixture(scope="session")
def motor(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The motor target, built with AddressSanitizer and UndefinedBehaviorSanitizer."""
    folder: Path = tmp_path_factory.mktemp("motor")
    return Program(compile_program(folder / "motor", [PROGRAMS / "motor.c", *platform_sources()]))


@pytest.fixture(scope="session")
def patient_motor(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The same, but overruns, which a loaded machine may cause in real time, never disable it."""
    folder: Path = tmp_path_factory.mktemp("patient_motor")
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    return Program(compile_program(folder / "motor", sources, defines=["OVERRUN_LIMIT=0"]))


@pytest.fixture(scope="session")
def connected_motor(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The motor with a middleware that prints "connected", and has no network."""
    folder: Path = tmp_path_factory.mktemp("connected_motor")
    sources = [PROGRAMS / "motor.c", *platform_sources()]
    return Program(compile_program(folder / "motor", sources, defines=["CONNECTED", "OVERRUN_LIMIT=0"]))
