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


def is_own_target_file(file: str) -> bool:
    """True for a file in EPG's own folder of targets: a project that must differ from it has a file that extends it."""
    return data_folder("targets") in Path(file).absolute().parents


def targets_roots(user_folders: Iterable[str | Path] = ()) -> tuple[Path, ...]:
    """The folders of targets in the order in which EPG searches them: the user's folders, then EPG's own folder."""
    return (*(Path(folder) for folder in user_folders if str(folder)), data_folder("targets"))
