# SPDX-License-Identifier: Apache-2.0
"""FetchContent beyond the matrix: another archive, two users in one project, no network."""

from __future__ import annotations

import hashlib
import re
import subprocess
import tarfile
from pathlib import Path

import pytest

from tests.cmake.matrix.cmakes import cmake

PROJECT = """cmake_minimum_required(VERSION 3.22...3.31)
project(firmware LANGUAGES NONE)
include(FetchContent)
set(find_first "")
if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
  set(find_first FIND_PACKAGE_ARGS)
endif()
FetchContent_Declare(EPG URL "@URL@" URL_HASH SHA256=@HASH@ ${find_first})
FetchContent_MakeAvailable(EPG)
which_epg()
"""

#: Another part of the project does not know the first one.
ASKS_AGAIN = "find_package(EPG REQUIRED)\nwhich_epg()\n"


def archive(folder: Path, name: str, text: str) -> tuple[str, str]:
    """An archive with EPG's own CMakeLists.txt and a replacement of its functions; its address and hash."""
    root = Path(__file__).resolve().parents[3]
    config = folder / "EPGConfig.cmake"
    config.write_text(f'function(which_epg)\n  message(STATUS "EPG is {text}")\nendfunction()\n')
    file = folder / f"{name}.tar.gz"
    with tarfile.open(file, "w:gz") as tar:
        tar.add(root / "CMakeLists.txt", "epg/CMakeLists.txt")
        tar.add(config, "epg/cmake/EPGConfig.cmake")
    return file.as_uri(), hashlib.sha256(file.read_bytes()).hexdigest()


@pytest.mark.parametrize("second", ["", ASKS_AGAIN], ids=["one asker", "two askers"])
@pytest.mark.parametrize("version", ["oldest", "newest"])
def test_another_archive_is_fetched_and_used(version: str, second: str, tmp_path: Path) -> None:
    source, build = tmp_path / "source", tmp_path / "build"
    source.mkdir()

    def configure(*arguments: str) -> str:
        command = [str(cmake(version)), "-S", str(source), "-B", str(build), "-G", "Ninja", *arguments]
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        assert done.returncode == 0, done.stdout
        assert "warning" not in done.stdout.lower(), done.stdout
        assert len(set(re.findall(r"EPG is .*", done.stdout))) == 1, done.stdout
        return done.stdout

    def declare(name: str, text: str) -> None:
        url, digest = archive(tmp_path, name, text)
        (source / "CMakeLists.txt").write_text(PROJECT.replace("@URL@", url).replace("@HASH@", digest) + second)

    declare("one", "the first")
    assert "EPG is the first\n" in configure()
    assert "EPG is the first\n" in configure()
    declare("two", "the second")
    assert "EPG is the second\n" in configure()
    for file in tmp_path.glob("*.tar.gz"):
        file.unlink()
    assert "EPG is the second\n" in configure("-DFETCHCONTENT_FULLY_DISCONNECTED=ON")
