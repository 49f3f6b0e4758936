# SPDX-License-Identifier: Apache-2.0
"""find_package(EPG <version>), for a checkout and for an installed wheel."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import epg
from tests.cmake.project import CMAKE_DIR, ROOT

HERE = epg.__version__
NEXT = "98.1"


@pytest.fixture(scope="module", params=["checkout", "wheel"])
def folder(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with EPGConfig.cmake and the file that answers questions about its version."""
    if request.param == "checkout":
        return CMAKE_DIR
    installed = tmp_path_factory.mktemp("share")
    (installed / "EPGConfig.cmake").write_text("")
    text = (CMAKE_DIR / "forwarder/EPGConfigVersion.cmake").read_text(encoding="utf-8")
    (installed / "EPGConfigVersion.cmake").write_text(text.replace("@VERSION@", HERE), encoding="utf-8")
    (installed / "EPGCompatible.cmake").write_bytes((CMAKE_DIR / "EPGCompatible.cmake").read_bytes())
    return installed


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ("", True),
        ("0.0.1", True),
        (HERE, True),
        (NEXT, False),
        (f"{HERE} EXACT", True),
        ("0.0.1 EXACT", False),
        (f"0.0.1...{NEXT}", True),
        (f"0.0.1...{HERE}", True),
        (f"0.0.1...<{HERE}", False),
        ("0.0.1...0.0.2", False),
        (f"{NEXT}...99", False),
    ],
)
def test_version(folder: Path, wanted: str, found: bool, tmp_path: Path) -> None:
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22...3.31)\nproject(x LANGUAGES NONE)\n"
        f"find_package(EPG {wanted} QUIET CONFIG NO_DEFAULT_PATH PATHS [==[{folder}]==])\n"
        'message(STATUS "found: ${EPG_FOUND} ${EPG_VERSION}")\n'
    )
    command = ["cmake", "-S", str(tmp_path), "-B", str(tmp_path / "build")]
    output = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    assert (f"found: 1 {HERE}\n" in output) == found, output


def test_the_checkout_of_an_editable_install_has_gone(tmp_path: Path) -> None:
    text = (ROOT / "cmake/forwarder/EPGConfig.editable.cmake").read_text(encoding="utf-8")
    (tmp_path / "EPGConfig.cmake").write_text(text.replace("@CHECKOUT@", "/gone"), encoding="utf-8")
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.22...3.31)\nproject(x LANGUAGES NONE)\nfind_package(EPG REQUIRED)\n"
    )
    command = ["cmake", "-S", str(tmp_path), "-B", str(tmp_path / "build"), f"-DEPG_DIR={tmp_path}"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode != 0
    expected = "the checkout of an editable installation was moved or deleted: there is no /gone/cmake/EPGConfig.cmake"
    assert expected in " ".join(done.stderr.split())
