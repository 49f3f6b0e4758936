from __future__ import annotations

from pathlib import Path

import pytest

from .program import PROGRAMS, Program, compile_program, platform_sources


@pytest.fixture(scope="session")
def motor(tmp_path_factory: pytest.TempPathFactory) -> Program:
    """The motor target, with AddressSanitizer and UndefinedBehaviorSanitizer."""
    folder: Path = tmp_path_factory.mktemp("motor")
    return Program(compile_program(folder / "motor", [PROGRAMS / "motor.c", *platform_sources()]))
