# SPDX-License-Identifier: Apache-2.0
"""Plug-ins: Python packages that bring commands, importers of models, and folders of targets.

A package names them as entry points of the groups ``epg.commands``, ``epg.importers`` and ``epg.targets``.  To list the
entry points of all installed packages takes longer than all else in a short run.  EPG does so only for a word that it
does not know itself, in lists of all that exists, and once while CMake configures, for ``epg find-tools``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.source import Span

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint


def entry_points(group: str) -> Mapping[str, EntryPoint]:
    """The entry points of a group such as ``commands``, by name.  Of two with one name, the first one counts."""
    from importlib import metadata

    return {each.name: each for each in reversed(list(metadata.entry_points(group=f"epg.{group}")))}


def load(entry: EntryPoint) -> Any:
    """The object of an entry point.  Raises UserError if the package cannot be imported."""
    try:
        return entry.load()
    except Exception as problem:
        package = entry.dist.name if entry.dist else entry.module
        message = f"the plug-in '{entry.name}' of {package} cannot be loaded: {type(problem).__name__}: {problem}"
        raise _broken(entry, message, f"pip uninstall {package}") from problem


def targets_folders() -> list[Path]:
    """The folders of targets of all plug-ins, sorted by their names.  Raises UserError for one that is missing."""
    folders = []
    for name, entry in sorted(entry_points("targets").items()):
        folder = Path(load(entry))
        if not folder.is_dir():
            message = f"the folder of targets of the plug-in '{name}' does not exist: {folder}"
            raise _broken(entry, message, "install the plug-in again")
        folders.append(folder)
    return folders


def _broken(entry: EntryPoint, message: str, hint: str) -> UserError:
    diagnostics = Diagnostics()
    diagnostics.error("plugin-broken", Span(entry.value), message, hint=hint)
    return UserError(diagnostics)
