"""The ways in which a project finds EPG: what it writes, and what its user passes and sets."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path


@dataclass(frozen=True)
class Installations:
    """EPG as somebody has it: where each way of finding it leads."""

    checkout: Path  #: a clone
    archive: Path  #: the clone's files as .tar.gz, as a forge offers them
    archive_sha256: str
    wheel_venv: Path  #: a virtual environment with the wheel
    editable_venv: Path  #: a virtual environment with the clone, installed with -e
    python: Path  #: any Python


@dataclass(frozen=True)
class Found:
    """How one way reaches EPG."""

    text: str  #: lines of the project, where it asks for EPG
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    copied: tuple[Path, ...] = ()  #: files that the project has copied from EPG


#: makes of the installations, and of whether the toolchain confines packages to a sysroot, what the way needs
Way = Callable[[Installations, bool], Found]

FIND = "find_package(EPG REQUIRED)\n"


def activated(venv: Path) -> dict[str, str]:
    """The environment after ``. venv/bin/activate``."""
    return {"VIRTUAL_ENV": str(venv), "PATH": f"{venv / 'bin'}{os.pathsep}{os.environ['PATH']}"}


def _python(have: Installations) -> str:
    return f"-DPython3_EXECUTABLE={have.python}"


def _in_venv(venv: Path, cmake_dir: Path, confined: bool) -> Found:
    # docs/cmake.md: where packages are confined, EPG_DIR is what `python -m epg --cmake-dir` prints
    return Found(FIND, (f"-DEPG_DIR={cmake_dir.as_posix()}",) if confined else (), activated(venv))


def wheel(have: Installations, confined: bool) -> Found:
    (site,) = have.wheel_venv.glob("lib/python*/site-packages")
    return _in_venv(have.wheel_venv, site / "epg/_data/cmake", confined)


def editable(have: Installations, confined: bool) -> Found:
    return _in_venv(have.editable_venv, have.checkout / "cmake", confined)


def checkout(have: Installations, confined: bool) -> Found:
    return Found(FIND, (_python(have), f"-DEPG_DIR={have.checkout / 'cmake'}"))


def checkout_prefix(have: Installations, confined: bool) -> Found:
    # a find root that holds the checkout is what a confined search needs
    where = "CMAKE_FIND_ROOT_PATH" if confined else "CMAKE_PREFIX_PATH"
    text = f'list(APPEND {where} "{have.checkout.as_posix()}")\n' + FIND
    return Found(text, (_python(have),))


def subdirectory(have: Installations, confined: bool) -> Found:
    return Found(f'add_subdirectory("{have.checkout.as_posix()}" third_party/epg)\n', (_python(have),))


def _fetch(declaration: str) -> str:
    return f"""include(FetchContent)
set(find_first "")
if(CMAKE_VERSION VERSION_GREATER_EQUAL 3.24)
  set(find_first FIND_PACKAGE_ARGS)
endif()
FetchContent_Declare(EPG {declaration})
FetchContent_MakeAvailable(EPG)
"""


def fetch_folder(have: Installations, confined: bool) -> Found:
    return Found(_fetch(f'SOURCE_DIR "{have.checkout.as_posix()}"'), (_python(have),))


def fetch_archive(have: Installations, confined: bool) -> Found:
    declaration = f'URL "{have.archive.as_uri()}" URL_HASH SHA256={have.archive_sha256}'
    return Found(_fetch(declaration), (_python(have),))


def fetch_unless_installed(have: Installations, confined: bool) -> Found:
    declaration = f'URL "{have.archive.as_uri()}" URL_HASH SHA256={have.archive_sha256} ${{find_first}}'
    # a second part of the project asks again, as it would if it did not know of the first
    return Found(_fetch(declaration) + FIND, (), activated(have.wheel_venv))


def fetch_disconnected(have: Installations, confined: bool) -> Found:
    arguments = ("-DFETCHCONTENT_FULLY_DISCONNECTED=ON", f"-DFETCHCONTENT_SOURCE_DIR_EPG={have.checkout}")
    return Found(_fetch("URL https://nowhere.invalid/epg.tar.gz"), (_python(have), *arguments))


def import_installed(have: Installations, confined: bool) -> Found:
    text = "include(epg_import.cmake)\n"
    return Found(text, (), activated(have.wheel_venv), (have.checkout / "cmake/epg_import.cmake",))


def import_path(have: Installations, confined: bool) -> Found:
    text = "include(epg_import.cmake)\n"
    arguments = (_python(have), f"-DEPG_PATH={have.checkout}")
    return Found(text, arguments, {}, (have.checkout / "cmake/epg_import.cmake",))


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
