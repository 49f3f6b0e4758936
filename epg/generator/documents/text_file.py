# SPDX-License-Identifier: Apache-2.0
"""Reads the text of the user's files.  Reports files that are too large or that are not UTF-8 text."""

from __future__ import annotations

import errno
import os
import re
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from epg.generator.diagnostics import Diagnostics, nearest, question
from epg.generator.install import long_path_remedy
from epg.generator.source import Span

MAX_BYTES = 1 << 20
# The characters that are not in c-printable of YAML 1.2.  One expression for all of them takes 3 ms to compile.
_CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f]")
_NO_CHARACTER = re.compile("[\ufffe\uffff]")

Drafts = Mapping[Path, str]
"""Texts that an editor has not saved yet.  They are read instead of the files."""
NO_DRAFTS: Drafts = MappingProxyType({})


ANOTHER_FILE = "is this the right file?"
"""The hint for a file that is too large: the user has probably named another file than intended."""


def too_large(name: str, limit: int) -> str:
    """The message for a file of more than ``limit`` bytes.  ``limit`` must be a multiple of 1 MiB."""
    return f"'{name}' is larger than {limit >> 20} MiB"


def read_text(
    path: Path, diagnostics: Diagnostics, wanted_by: Span | None = None, drafts: Drafts = NO_DRAFTS
) -> str | None:
    """The UTF-8 text of ``path``, or None after reporting why it cannot be read.

    ``wanted_by`` is the position at which the name of the file is written.  Problems with the file as a whole are
    reported there.
    """
    whole = wanted_by or Span(str(path))
    try:
        if path in drafts:
            data = drafts[path].encode("utf-8")
        else:
            with path.open("rb") as file:
                data = file.read(MAX_BYTES + 1)
    except FileNotFoundError:
        hint = long_path_remedy(str(path)) or _neighbours(path)
        diagnostics.error("file-not-found", whole, f"there is no file '{path.name}'", hint=hint)
        return None
    except OSError as error:
        reason = os.strerror(errno.EISDIR) if path.is_dir() else error.strerror or error  # Windows permits no folder
        message = f"cannot read '{path.name}': {reason}"
        diagnostics.error("file-unreadable", whole, message, hint=long_path_remedy(str(path)))
        return None
    if len(data) > MAX_BYTES:
        diagnostics.error("file-too-large", whole, too_large(path.name, MAX_BYTES), hint=ANOTHER_FILE)
        return None
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line, column = _position(data[: error.start].decode("utf-8-sig", "replace"))
        diagnostics.error(
            "not-utf-8", Span(str(path), line, column, column + 1), "this is not UTF-8 text", hint="save it as UTF-8"
        )
        return None
    bad = _CONTROL.search(text) or _NO_CHARACTER.search(text)
    if bad:
        line, column = _position(text[: bad.start()])
        span = Span(str(path), line, column, column + 1)
        diagnostics.error(
            "control-character", span, f"the file has the control character U+{ord(bad[0]):04X}", hint="remove it"
        )
        return None
    return text


def is_file(path: Path) -> bool:
    """True if the file exists.  Never raises: for a name that the system does not accept, the result is False."""
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def is_folder(path: Path) -> bool:
    """True if the folder exists.  Never raises, as :func:`is_file`."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def one_line(text: str) -> str:
    """A name, unit or description that is safe to print: control characters and line ends become ``?``.

    >>> one_line("in\\x1b[2J")
    'in?[2J'
    """
    return text if text.isprintable() else "".join(char if char.isprintable() else "?" for char in text)


def _position(before: str) -> tuple[int, int]:
    lines = re.split("\r\n|\r|\n|\x85|\u2028|\u2029", before)
    return len(lines), len(lines[-1]) + 1


_YAML = (".yaml", ".yml")


def _neighbours(path: Path) -> str:
    """The hint for a missing file: a similar file of the same kind in its folder, or all of them, at most 12."""
    suffixes = _YAML if path.suffix in _YAML else (path.suffix,)
    try:
        names = sorted(entry.name for entry in path.parent.iterdir() if entry.suffix in suffixes)
    except OSError:
        return f"there is no folder '{path.parent.name}' either"
    near = nearest(path.name, names)
    if near:
        return question(near, path.name)
    return f"files in that folder: {', '.join(names[:12])}" if names else ""
