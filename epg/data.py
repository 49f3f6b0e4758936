# SPDX-License-Identifier: Apache-2.0
"""Where EPG's own files are, in a checkout, an editable install and a wheel alike."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from pathlib import Path


@cache
def data_folder(name: str) -> Path:
    """The folder ``cmake``, ``targets`` or ``schemas``: beside the package in a checkout, inside it in a wheel."""
    package = Path(__file__).resolve().parent
    for candidate in (package / "_data" / name, package.parent / name):
        if candidate.is_dir():
            return candidate
    raise FileNotFoundError(f"EPG's folder '{name}' is missing beside {package}")


def targets_roots(user_folders: Iterable[str | Path] = ()) -> tuple[Path, ...]:
    """The folders searched for boards, platforms, kinds and robots: the user's first, then EPG's own."""
    return (*(Path(folder) for folder in user_folders if str(folder)), data_folder("targets"))
