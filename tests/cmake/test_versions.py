# SPDX-License-Identifier: Apache-2.0
"""find_package(EPG <version>), for a checkout and for an installed wheel."""

from __future__ import annotations

import shutil
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


@pytest.mark.parametrize("way", ["add_subdirectory", "find_package"])
def test_two_in_one_build_are_an_error(way: str, tmp_path: Path) -> None:
    """Each of two projects brings its own EPG."""
    for name in ("CMakeLists.txt", "cmake", "targets", "epg/__init__.py"):
        file = tmp_path / "two/epg" / name
        file.parent.mkdir(parents=True, exist_ok=True)
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, file)
        else:
            text = (ROOT / name).read_text(encoding="utf-8")
            file.write_text(text.replace(f'__version__ = "{HERE}"', f'__version__ = "{NEXT}"'), encoding="utf-8")
    (tmp_path / "one").mkdir()
    (tmp_path / "link").symlink_to(ROOT)  # the same EPG under another name is no second one
    texts = {
        ".": "project(both LANGUAGES NONE)\nadd_subdirectory(one)\nadd_subdirectory(two)\n",
        "one": f'add_subdirectory("{ROOT}" epg)\nset(EPG_DIR "{tmp_path}/link/cmake")\nfind_package(EPG REQUIRED)\n',
        "two": "add_subdirectory(epg)\n"
        if way == "add_subdirectory"
        else f'set(EPG_DIR "{tmp_path}/two/epg/cmake")\nfind_package(EPG REQUIRED)\n',
    }
    for folder, text in texts.items():
        (tmp_path / folder / "CMakeLists.txt").write_text(f"cmake_minimum_required(VERSION 3.22)\n{text}")
    done = subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build"], capture_output=True, text=True)
    assert done.returncode != 0, done.stdout
    folders = f"  {HERE} in {ROOT}/cmake\n    {NEXT} in {tmp_path}/two/epg/cmake\n"
    assert f"EPG: two EPGs are used in one build.\n\n  {folders}" in done.stderr, done.stderr
