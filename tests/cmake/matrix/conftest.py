# SPDX-License-Identifier: Apache-2.0
"""Fixtures: EPG in every form in which a user may have it."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
import tarfile
import venv
from pathlib import Path

import pytest

from tests.cmake.matrix.ways import Installations
from tests.cmake.project import ROOT

IN_ARCHIVE = ("CMakeLists.txt", "cmake", "docs", "epg", "schemas", "targets")


def _venv(folder: Path, version: str) -> Path:
    """A virtual environment with EPG's standard or editable wheel."""
    code = (
        "import sys; from hatchling.builders.wheel import WheelBuilder;"
        "print(next(WheelBuilder(sys.argv[1]).build(directory=sys.argv[2], versions=[sys.argv[3]])))"
    )
    wheels = folder / "wheels"
    subprocess.run([sys.executable, "-c", code, str(ROOT), str(wheels), version], check=True, capture_output=True)
    (wheel,) = wheels.glob("*.whl")
    environment = folder / "venv"
    venv.EnvBuilder(with_pip=True, symlinks=os.name != "nt").create(environment)
    install = ["pip", "--disable-pip-version-check", "install", "--quiet", "--no-index", "--no-deps", str(wheel)]
    subprocess.run([environment / "bin/python", "-m", *install], check=True)
    return environment


@pytest.fixture(scope="session")
def installations(tmp_path_factory: pytest.TempPathFactory) -> Installations:
    folder = tmp_path_factory.mktemp("installations")
    archive = folder / "epg-main.tar.gz"
    with tarfile.open(archive, "w:gz") as tar:
        for name in IN_ARCHIVE:
            tar.add(ROOT / name, f"epg-main/{name}", filter=lambda m: None if "__pycache__" in m.name else m)
    return Installations(
        checkout=ROOT,
        archive=archive,
        archive_sha256=hashlib.sha256(archive.read_bytes()).hexdigest(),
        wheel_venv=_venv(folder / "wheel", "standard"),
        editable_venv=_venv(folder / "editable", "editable"),
        python=Path(sys.executable),
    )
