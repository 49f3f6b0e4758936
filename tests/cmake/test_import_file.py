# SPDX-License-Identifier: Apache-2.0
"""The copied ``epg_import.cmake``: the places that it searches, their order, and its messages."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

import pytest

from epg.generator.install import ACTIVATE, REMEDIES, install_command
from tests.cmake.project import CMAKE_DIR

PROJECT = """cmake_minimum_required(VERSION 3.22...3.31)
project(firmware LANGUAGES NONE)
include(epg_import.cmake)
include(epg_import.cmake) # another part of the project does not know of the first
message(STATUS "EPG of ${EPG_DIR}")
"""

STAND_IN = "function(epg_add_target)\nendfunction()\n"

BUILD_PROGRAM = "ninja" if shutil.which("ninja") else "make"


class User:
    """A user with a project that has copied the file, replacements of checkouts, and programs on the PATH."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.source = folder / "source"
        self.source.mkdir(parents=True)
        (self.source / "CMakeLists.txt").write_text(PROJECT)
        shutil.copy(CMAKE_DIR / "epg_import.cmake", self.source)
        self.programs = folder / "programs"
        self.programs.mkdir()
        # only CMake and the programs of the test, so that this computer's own EPG cannot be found
        for name in ("cmake", BUILD_PROGRAM, "sh"):
            (self.programs / name).symlink_to(shutil.which(name) or name)

    def checkout(self, name: str) -> Path:
        """A replacement of EPG's repository."""
        cmake = self.folder / name / "cmake"
        cmake.mkdir(parents=True)
        (cmake / "EPGConfig.cmake").write_text(STAND_IN)
        return cmake.parent

    def program(self, name: str, leads_to: Path, arguments: str) -> None:
        """A program that answers ``<name> <arguments>`` with the folder of a checkout, and records each call."""
        file = self.programs / name
        file.write_text(
            f'#!/bin/sh\necho {name} >>"{self.folder}/asked"\n'
            f'[ "$*" = "{arguments}" ] || exit 1\nprintf "%s\\n" "{leads_to / "cmake"}"\n'
        )
        file.chmod(0o755)

    @property
    def asked(self) -> list[str]:
        note = self.folder / "asked"
        return note.read_text().split() if note.exists() else []

    def configure(self, *arguments: str, check: bool = True, variables: Mapping[str, str] | None = None) -> str:
        done = subprocess.run(
            [
                shutil.which("cmake") or "cmake",
                "-S",
                self.source,
                "-B",
                self.folder / "build",
                "-G",
                "Ninja" if BUILD_PROGRAM == "ninja" else "Unix Makefiles",
                *arguments,
            ],
            env={"PATH": str(self.programs), "HOME": str(self.folder), **(variables or {})},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert (done.returncode == 0) == check, done.stdout
        return done.stdout if check else " ".join(done.stdout.split())


pytestmark = pytest.mark.skipif(os.name == "nt", reason="the stand-ins are shell scripts")


@pytest.fixture
def user(tmp_path: Path) -> User:
    return User(tmp_path / "user")


def test_a_checkout_goes_before_a_package(user: User) -> None:
    path, other, installed = user.checkout("path"), user.checkout("other"), user.checkout("installed")
    user.program("python3", installed, "-m epg --cmake-dir")
    found = f"EPG of {path}/cmake\n"
    assert found in user.configure(f"-DEPG_PATH={path}", variables={"EPG_PATH": str(other)})
    assert found in user.configure()
    assert user.asked == []


@pytest.mark.parametrize("variable", ["EPG_PATH", "EPG_DIR"])
def test_environment(user: User, variable: str) -> None:
    checkout = user.checkout("somewhere")
    value = {"EPG_PATH": checkout, "EPG_DIR": checkout / "cmake"}[variable]
    assert f"EPG of {checkout}/cmake\n" in user.configure(variables={variable: str(value)})


def test_a_relative_path_begins_at_the_project(user: User) -> None:
    checkout = user.checkout("source/third_party/epg")
    assert f"EPG of {checkout}/cmake\n" in user.configure("-DEPG_PATH=third_party/epg")


@pytest.mark.parametrize(("program", "arguments"), [("python3", "-m epg"), ("python", "-m epg"), ("epg", "")])
def test_an_installed_package_is_asked_for_once(user: User, program: str, arguments: str) -> None:
    installed = user.checkout("installed")
    user.program(program, installed, f"{arguments} --cmake-dir".strip())
    assert f"EPG of {installed}/cmake\n" in user.configure()
    assert user.asked == [program]
    assert f"EPG of {installed}/cmake\n" in user.configure()
    assert user.asked == [program]


def test_the_selected_python_is_asked_first(user: User) -> None:
    usual, selected = user.checkout("usual"), user.checkout("selected")
    user.program("python3", usual, "-m epg --cmake-dir")
    user.program("python3.99", selected, "-m epg --cmake-dir")
    found = user.configure(f"-DPython3_EXECUTABLE={user.programs / 'python3.99'}")
    assert f"EPG of {selected}/cmake\n" in found


def test_what_is_set_later_replaces_what_was_found(user: User) -> None:
    installed, checkout = user.checkout("installed"), user.checkout("checkout")
    user.program("python3", installed, "-m epg --cmake-dir")
    assert f"EPG of {installed}/cmake\n" in user.configure()
    assert f"EPG of {checkout}/cmake\n" in user.configure(f"-DEPG_PATH={checkout}")
    assert f"EPG of {installed}/cmake\n" in user.configure("-UEPG_PATH", f"-DEPG_DIR={installed}/cmake")


def test_what_has_gone_is_looked_for_again(user: User) -> None:
    old, new = user.checkout("old"), user.checkout("new")
    user.program("python3", old, "-m epg --cmake-dir")
    user.configure()
    shutil.rmtree(old)
    user.program("python3", new, "-m epg --cmake-dir")
    assert f"EPG of {new}/cmake\n" in user.configure()


def test_a_project_around_this_one_decides(user: User) -> None:
    around = user.checkout("around")
    (user.source / "CMakeLists.txt").write_text(f'include("{around}/cmake/EPGConfig.cmake")\n{PROJECT}')
    user.program("python3", user.checkout("installed"), "-m epg --cmake-dir")
    user.configure()
    assert user.asked == []


def test_nothing_found(user: User) -> None:
    message = user.configure(check=False)
    assert "EPG was not found. If it is installed in a virtual environment, activate that first:" in message
    assert f" {ACTIVATE} Else install it from its folder" in message
    assert f" {install_command()} or name the folder: cmake -DEPG_PATH=<folder of EPG> ..." in message


def test_nothing_found_on_windows(user: User) -> None:
    project = (user.source / "CMakeLists.txt").read_text()
    (user.source / "CMakeLists.txt").write_text(project.replace("include", "set(CMAKE_HOST_WIN32 TRUE)\ninclude", 1))
    message = user.configure(check=False)
    assert r" %USERPROFILE%\epg-environment\Scripts\activate Else install it" in message
    assert f" {REMEDIES['epg']['windows'].format(folder='<folder of EPG>')} or name the folder:" in message


def test_py_of_windows(user: User) -> None:
    installed = user.checkout("installed")
    user.program("py", installed, "-m epg --cmake-dir")
    assert f"EPG of {installed}/cmake\n" in user.configure()


def test_a_wrong_path_is_named(user: User) -> None:
    message = user.configure("-DEPG_PATH=/nowhere", check=False)
    assert "EPG_PATH is not a checkout of EPG: there is no /nowhere/cmake/EPGConfig.cmake" in message


def test_a_wrong_dir_is_named(user: User) -> None:
    checkout = user.checkout("checkout")
    message = user.configure(f"-DEPG_DIR={checkout}", check=False)
    assert "EPG_DIR is not the folder of EPGConfig.cmake, which 'python -m epg --cmake-dir' prints:" in message


# Zephyr ---------------------------------------------------------------------------------------------------------------


def test_west_is_asked_for_the_workspaces_epg(user: User) -> None:
    """If west configures, its answer is kept and has priority over `pip`'s.  The real west: tests/zephyr."""
    workspace, installed = user.checkout("workspace/epg"), user.checkout("installed")
    user.program("python3", installed, "-m epg --cmake-dir")
    west = user.programs / "west_python"
    west.write_text(
        f'#!/bin/sh\necho west >>"{user.folder}/asked"\n'
        f'[ "$*" = "-m west list -f {{abspath}} epg" ] && printf "%s\\n" "{workspace}"\n'
    )
    west.chmod(0o755)
    assert f"EPG of {workspace}/cmake\n" in user.configure(f"-DWEST_PYTHON={west}")
    assert f"EPG of {workspace}/cmake\n" in user.configure()
    assert user.asked == ["west"]
    path = user.checkout("path")
    assert f"EPG of {path}/cmake\n" in user.configure(f"-DEPG_PATH={path}")


def test_a_workspace_without_epg(user: User) -> None:
    installed = user.checkout("installed")
    user.program("python3", installed, "-m epg --cmake-dir")
    user.program("west_python", installed, "no such project")
    assert f"EPG of {installed}/cmake\n" in user.configure(f"-DWEST_PYTHON={user.programs / 'west_python'}")


@pytest.mark.parametrize("variable", ["ZEPHYR_MODULES", "EXTRA_ZEPHYR_MODULES", "ZEPHYR_EXTRA_MODULES"])
@pytest.mark.parametrize("way", ["command line", "environment", "sysbuild"])
def test_a_module_of_zephyr(user: User, variable: str, way: str) -> None:
    """Without a west manifest, a variable lists the modules; another one is before EPG."""
    module = user.checkout("modules/epg")
    user.program("python3", user.checkout("installed"), "-m epg --cmake-dir")
    modules = f"{user.folder}/other;{module}"
    cache = user.folder / "sysbuild_cache.txt"
    cache.write_text(f"{variable}:STRING={modules}\nBOARD:STRING=rpi_pico\n" if way == "sysbuild" else "")
    output = user.configure(
        *([f"-D{variable}={modules}"] if way == "command line" else []),
        "-DSYSBUILD:BOOL=True",
        f"-DSYSBUILD_CACHE:FILEPATH={cache}",
        variables={variable: modules} if way == "environment" else {},
    )
    assert f"EPG of {module}/cmake\n" in output
    assert f"EPG of {user.checkout('path')}/cmake\n" in user.configure(f"-DEPG_PATH={user.folder / 'path'}")


def test_an_image_of_sysbuild(user: User) -> None:
    """A file contains the variables that were given to sysbuild; an image gets the path of that file."""
    checkout = user.checkout("some where")
    cache = user.folder / "sysbuild_cache.txt"
    cache.write_text(f"BOARD:STRING=rpi_pico\nEPG_PATH:UNINITIALIZED={checkout}\nOTHER_EPG_PATH:PATH=/nowhere\n")
    output = user.configure("-DSYSBUILD:BOOL=True", f"-DSYSBUILD_CACHE:FILEPATH={cache}")
    assert f"EPG of {checkout}/cmake\n" in output
