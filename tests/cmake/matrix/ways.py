# SPDX-License-Identifier: Apache-2.0
"""The ways in which a project finds EPG: the project's text, and the arguments and variables of its user."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Installations:
    """EPG in all its forms: the places to which the ways of finding it lead."""

    checkout: Path  #: a clone
    archive: Path  #: the clone's files as .tar.gz, as a forge offers them
    archive_sha256: str
    wheel_venv: Path  #: a virtual environment with the wheel
    editable_venv: Path  #: a virtual environment with the clone, installed with -e
    python: Path  #: any Python


@dataclass(frozen=True)
class Found:
    """The means by which one way finds EPG."""

    text: str  #: lines of the project that find EPG
    leads_to: Path  #: the folder above EPG's ``cmake``; relative to the build folder
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    copied: tuple[Path, ...] = ()  #: files that the project has copied from EPG


@dataclass(frozen=True)
class Conditions:
    """The conditions on which a way depends."""

    confined: bool  #: the toolchain file restricts the search for packages to its sysroot
    oldest: bool  #: the oldest CMake


Way = Callable[[Installations, Conditions], Found]

FETCHED = Path("_deps/epg-src")

FIND = "find_package(EPG REQUIRED)\n"


def activated(venv: Path) -> dict[str, str]:
    """The environment after ``. venv/bin/activate``."""
    return {"VIRTUAL_ENV": str(venv), "PATH": f"{venv / 'bin'}{os.pathsep}{os.environ['PATH']}"}


def _python(have: Installations) -> str:
    return f"-DPython3_EXECUTABLE={have.python}"


def _in_wheel(have: Installations) -> Path:
    (site,) = have.wheel_venv.glob("lib/python*/site-packages")
    return site / "epg/_data"


def _in_venv(venv: Path, root: Path, when: Conditions) -> Found:
    # docs/cmake.md: where packages are confined, EPG_DIR is the output of `python -m epg --cmake-dir`
    return Found(FIND, root, (f"-DEPG_DIR={root / 'cmake'}",) if when.confined else (), activated(venv))


def wheel(have: Installations, when: Conditions) -> Found:
    return _in_venv(have.wheel_venv, _in_wheel(have), when)


def editable(have: Installations, when: Conditions) -> Found:
    return _in_venv(have.editable_venv, have.checkout, when)


def checkout(have: Installations, when: Conditions) -> Found:
    return Found(FIND, have.checkout, (_python(have), f"-DEPG_DIR={have.checkout / 'cmake'}"))


def checkout_prefix(have: Installations, when: Conditions) -> Found:
    # a confined search needs a find root that contains the checkout
    where = "CMAKE_FIND_ROOT_PATH" if when.confined else "CMAKE_PREFIX_PATH"
    text = f'list(APPEND {where} "{have.checkout.as_posix()}")\n' + FIND
    return Found(text, have.checkout, (_python(have),))


def subdirectory(have: Installations, when: Conditions) -> Found:
    text = f'add_subdirectory("{have.checkout.as_posix()}" third_party/epg)\n'
    return Found(text, have.checkout, (_python(have),))


def _fetch(declaration: str) -> str:
    return f"""include(FetchContent)
set(find_first "")
if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
  set(find_first FIND_PACKAGE_ARGS)
endif()
FetchContent_Declare(EPG {declaration})
FetchContent_MakeAvailable(EPG)
"""


def fetch_folder(have: Installations, when: Conditions) -> Found:
    return Found(_fetch(f'SOURCE_DIR "{have.checkout.as_posix()}"'), have.checkout, (_python(have),))


def _archive(have: Installations) -> str:
    return f'URL "{have.archive.as_uri()}" URL_HASH SHA256={have.archive_sha256}'


def fetch_archive(have: Installations, when: Conditions) -> Found:
    return Found(_fetch(_archive(have)), FETCHED, (_python(have),))


def fetch_unless_installed(have: Installations, when: Conditions) -> Found:
    # a second part of the project searches EPG again, because it does not know the first one
    text = _fetch(_archive(have) + " ${find_first}") + FIND
    root = FETCHED if when.confined or when.oldest else _in_wheel(have)
    return Found(text, root, (), activated(have.wheel_venv))


def fetch_disconnected(have: Installations, when: Conditions) -> Found:
    arguments = ("-DFETCHCONTENT_FULLY_DISCONNECTED=ON", f"-DFETCHCONTENT_SOURCE_DIR_EPG={have.checkout}")
    return Found(_fetch("URL https://nowhere.invalid/epg.tar.gz"), have.checkout, (_python(have), *arguments))


IMPORT = "include(epg_import.cmake)\n"


def import_installed(have: Installations, when: Conditions) -> Found:
    copied = (have.checkout / "cmake/epg_import.cmake",)
    return Found(IMPORT, _in_wheel(have), (), activated(have.wheel_venv), copied)


def import_path(have: Installations, when: Conditions) -> Found:
    copied = (have.checkout / "cmake/epg_import.cmake",)
    return Found(IMPORT, have.checkout, (_python(have), f"-DEPG_PATH={have.checkout}"), {}, copied)


WAYS: dict[str, Way] = {
    way.__name__: way
    for way in (
        wheel,
        editable,
        checkout,
        checkout_prefix,
        subdirectory,
        fetch_folder,
        fetch_archive,
        fetch_unless_installed,
        fetch_disconnected,
        import_installed,
        import_path,
    )
}
