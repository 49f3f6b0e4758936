# SPDX-License-Identifier: Apache-2.0
"""The oldest CMake that EPG supports and the newest that exists, from PyPI, in EPG's cache."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from functools import cache
from pathlib import Path

import pytest

from epg.generator.bootstrap import cache_folder

OLDEST = "3.22.6"

#: PyPI is asked for a newer version after this many seconds.
RENEW = 7 * 24 * 3600


@cache
def cmake(which: str) -> Path:
    """The program ``cmake``: ``"oldest"`` or ``"newest"``.  Skips the test if it is neither cached nor available."""
    if which == "oldest":
        folder = cache_folder() / f"test-cmake-{OLDEST}"
        if not folder.is_dir():
            _install(f"cmake=={OLDEST}")
        return _program(folder)
    note = cache_folder() / "test-cmake-newest"
    if note.is_file() and time.time() - note.stat().st_mtime < RENEW:  # the age of the cache on this computer
        return _program(cache_folder() / f"test-cmake-{note.read_text()}")
    try:
        version = _install("cmake")
    except pytest.skip.Exception:
        if not note.is_file():
            raise
        version = note.read_text()  # a previous newest version, because PyPI is not available now
    _write(note, version)
    return _program(cache_folder() / f"test-cmake-{version}")


def _program(folder: Path) -> Path:
    return folder / "cmake/data/bin" / ("cmake.exe" if os.name == "nt" else "cmake")


def _install(requirement: str) -> str:
    """Installs a CMake into the cache, completely or not at all; returns its version."""
    cache_folder().mkdir(parents=True, exist_ok=True)
    temporary = Path(tempfile.mkdtemp(dir=cache_folder(), prefix=".test-cmake."))
    command = [sys.executable, "-m", "pip", "--disable-pip-version-check", "install", "--quiet", "--no-input"]
    command += ["--no-deps", "--only-binary", ":all:", "--target", str(temporary), requirement]
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if done.returncode != 0:
            reason = (done.stderr.strip().splitlines() or ["pip failed"])[-1]
            pytest.skip(f"{requirement} cannot be installed from PyPI: {reason}")
        (info,) = temporary.glob("cmake-*.dist-info")
        version = re.sub(r"cmake-(.*)\.dist-info", r"\1", info.name)
        folder = cache_folder() / f"test-cmake-{version}"
        try:
            os.rename(temporary, folder)
        except OSError:
            if not folder.is_dir():  # another test process may have been faster
                raise
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    return version


def _write(file: Path, text: str) -> None:
    temporary = file.with_name(f".{file.name}.{os.getpid()}")
    temporary.write_text(text)
    os.replace(temporary, file)
