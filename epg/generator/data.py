# SPDX-License-Identifier: Apache-2.0
"""The places of EPG's own files.  They are found in a checkout, in an editable install and in a wheel."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path


@cache
def data_folder(name: str) -> Path:
    """A folder of EPG such as ``cmake``, ``targets`` or ``schemas``.

    In a checkout it is beside the Python package, in a wheel it is inside the package.
    """
    package = Path(__file__).resolve().parent.parent
    for candidate in (package / "_data" / name, package.parent / name):
        if candidate.is_dir():
            return candidate
    raise FileNotFoundError(f"EPG's folder '{name}' is missing beside {package}")


@cache
def own_roots() -> tuple[Path, ...]:
    """The folders of targets that come with EPG: those in ``integration``, which nothing else names, and ``targets``.

    ``cmake/EPGPython.cmake`` has the same list.
    """
    targets = data_folder("targets")
    return (*sorted(targets.parent.glob("integration/*/targets")), targets)


def is_own_target_file(file: str) -> bool:
    """True for a file in EPG's own folders of targets: a project that must differ from it has one that extends it."""
    return not set(own_roots()).isdisjoint(Path(file).absolute().parents)


def targets_roots(user_folders: Iterable[str | Path] = ()) -> tuple[Path, ...]:
    """The folders of targets in the order in which EPG searches them: the user's folders, then EPG's own folders."""
    return (*(Path(folder) for folder in user_folders if str(folder)), *own_roots())
