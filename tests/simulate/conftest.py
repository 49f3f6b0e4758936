"""A host executable for the tests of simulation runs: the motor of the host platform's own tests."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def motor(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Topic ``motor_setpoint``; signals ``inputs.position``, ``outputs.duty``; disabled by 3 overruns in a row."""
    compiler = shutil.which("gcc") or shutil.which("cc")
    assert compiler is not None, "a C compiler is needed"
    host, runtime = ROOT / "targets" / "platforms" / "host", ROOT / "targets" / "runtime"
    sources = [*sorted((runtime / "src").glob("*.c")), *sorted((host / "src").glob("*.c"))]
    sources.append(ROOT / "tests" / "platforms" / "host" / "programs" / "motor.c")
    output = tmp_path_factory.mktemp("motor") / "motor_host"
    command = [compiler, "-std=c11", "-O1", "-DEPG_HOST_TARGET=epg_host_application"]
    command += [f"-I{folder}" for folder in (runtime / "include", host / "include", host / "src")]
    subprocess.run([*command, *map(str, sources), "-pthread", "-lm", "-o", str(output)], check=True)
    return output
