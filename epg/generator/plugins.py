# SPDX-License-Identifier: Apache-2.0
"""Plug-ins: Python packages that bring commands, importers of models, and folders of targets.

A package names them as entry points of the groups ``epg.commands``, ``epg.importers`` and ``epg.targets``.  To list the
entry points of all installed packages takes longer than all else in a short run.  EPG does so only for a word that it
does not know itself, in lists of all that exists, and once while CMake configures, for ``epg find-tools``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
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


def load(entry: EntryPoint, wanted: str, fits: Callable[[Any], object]) -> Any:
    """The object of an entry point.  Raises UserError if the package cannot be imported.

    It raises it also for an object that does not ``fit``; ``wanted`` says what it must be.
    """
    try:
        found = entry.load()
    except Exception as problem:
        message = f"{named(entry)} cannot be loaded: {type(problem).__name__}: {problem}"
        raise broken(entry, message, f"pip uninstall {_package(entry)}") from problem
    if not fits(found):
        message = f"{named(entry)} must be {wanted}, and is {_what(found)}"
        hint = f"write '{entry.attr or 'NAME'} = {found.__name__}()'" if isinstance(found, type) else ""
        raise broken(entry, message, hint or "docs/plugins.md says what each entry point must name")
    return found


def targets_folders() -> list[Path]:
    """The folders of targets of all plug-ins, sorted by their names.  Raises UserError for one that is missing."""
    folders = []
    for name, entry in sorted(entry_points("targets").items()):
        folder = Path(load(entry, "the path of a folder", lambda found: isinstance(found, (str, Path))))
        if not folder.is_dir():
            message = f"the folder of targets of the plug-in '{name}' does not exist: {folder}"
            raise broken(entry, message, "install the plug-in again")
        folders.append(folder)
    return folders


def broken(entry: EntryPoint, message: str, hint: str) -> UserError:
    """The error for a plug-in."""
    diagnostics = Diagnostics()
    diagnostics.error("plugin-broken", Span(entry.value), message, hint=hint)
    return UserError(diagnostics)


def _package(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist else entry.module


def named(entry: EntryPoint) -> str:
    """The plug-in as messages name it, with its package."""
    return f"the plug-in '{entry.name}' of {_package(entry)}"


def _what(found: object) -> str:
    return f"the class '{found.__name__}'" if isinstance(found, type) else f"of type '{type(found).__name__}'"
