# SPDX-License-Identifier: Apache-2.0
"""Reads the files of a session as text, replaces them atomically, and watches them for edits by other programs.

Saving keeps the line ends of a file, its byte order mark, its permissions, and a symbolic link that leads to it
within the project.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.documents.text_file import MAX_BYTES
from epg.generator.emit.leftovers import replace_file

BOM = b"\xef\xbb\xbf"


class Unsavable(Exception):
    """A file cannot be written, or has changed since it was read.  The message names the file and the reason."""


@dataclass(frozen=True)
class Snapshot:
    """The contents of a text file at one moment.  ``data`` is None if there was no readable file."""

    path: Path
    data: bytes | None

    @property
    def text(self) -> str | None:
        """The text without its byte order mark; None if there is no file, it is too large, or it is not UTF-8."""
        if self.data is None or len(self.data) > MAX_BYTES:
            return None
        try:
            return self.data.decode("utf-8-sig")
        except UnicodeDecodeError:
            return None

    def with_text(self, text: str) -> Snapshot:
        """The same file with another text; a byte order mark is kept."""
        mark = BOM if self.data is not None and self.data.startswith(BOM) else b""
        return Snapshot(self.path, mark + text.encode("utf-8"))


def read_snapshot(path: Path) -> Snapshot:
    """The file as it is now.  A file that cannot be read counts as missing: loading it reports the reason."""
    try:
        with path.open("rb") as file:
            return Snapshot(path, file.read(MAX_BYTES + 1))
    except (OSError, ValueError):
        return Snapshot(path, None)


def save(before: Snapshot, after: Snapshot, *, project: Path | None = None, anyway: bool = False) -> None:
    """Replaces the file ``before`` by ``after``, if it has not changed since; with ``anyway`` also if it has.

    Removes the file if ``after`` has no data.

    The replacement is atomic: another program that reads the file sees the old or the new contents, never a mixture.
    If the file is a symbolic link, the file that it leads to is replaced and keeps its permissions; the link stays.
    The link must not lead out of ``project``, the folder of the project.  If the file is not in ``project``, or if
    ``project`` is None, the link must not lead out of the file's own folder.

    Raises :class:`Unsavable`; the file is then unchanged.
    """
    target = Path(os.path.realpath(before.path))
    _check_links(before.path, target, project)
    if not anyway and read_snapshot(target).data != before.data:
        raise Unsavable(f"another program changed '{before.path.name}' after EPG had read it")
    try:
        if after.data is None:
            target.unlink(missing_ok=True)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not os.access(target, os.W_OK):
            raise Unsavable(f"'{before.path.name}' is write-protected")
        mode = target.stat().st_mode & 0o7777 if target.exists() else None
        replace_file(target, after.data, mode, durable=True)
    except OSError as error:
        raise Unsavable(f"cannot write '{before.path.name}': {error.strerror or error}") from error


def _check_links(path: Path, target: Path, project: Path | None) -> None:
    """Raises Unsavable if ``path`` is a link that leads out of the project: the user has not named that file."""
    path = Path(os.path.abspath(path))
    inside = project if project is not None and Path(os.path.abspath(project)) in path.parents else path.parent
    if Path(os.path.realpath(inside)) not in target.parents:
        raise Unsavable(
            f"'{path.name}' is a link to '{target}', outside of '{inside}': EPG does not write there; "
            "replace the link by a copy, or name that file itself in CMakeLists.txt"
        )


class Watch:
    """Notices when the contents of some files change.

    A file is read again only if its status has changed (times, size, inode), so two looks a second cost little.
    """

    def __init__(self, paths: Iterable[Path] = (), read: Iterable[Snapshot] = ()) -> None:
        """``read`` are files with the contents that were read earlier: a change since then counts, too."""
        self._known: dict[Path, tuple[tuple[int, ...], bytes]] = {
            path: (_status(path), _digest(path)) for path in paths
        }
        for snapshot in read:
            digest = hashlib.sha256(snapshot.data).digest() if snapshot.data is not None else b""
            self._known[snapshot.path] = ((-1,), digest)

    def newest(self) -> float:
        """The time of the latest change of any of the files, in seconds since 1970; 0 if none exists."""
        return max((status[0] * 1e-9 for status, _ in self._known.values() if len(status) > 1), default=0.0)

    def changed(self) -> list[Path]:
        """The files that have changed since the last call, sorted."""
        paths = []
        for path, (status, digest) in self._known.items():
            now = _status(path)
            if now == status:
                continue
            contents = _digest(path)
            self._known[path] = (now, contents)
            if contents != digest:
                paths.append(path)
        return sorted(paths)


def _status(path: Path) -> tuple[int, ...]:
    try:
        status = path.stat()
    except (OSError, ValueError):
        return ()
    return (status.st_mtime_ns, status.st_ctime_ns, status.st_size, status.st_ino)


def _digest(path: Path) -> bytes:
    """A hash of the contents of a file, or of the names in a folder; empty if there is neither."""
    try:
        if path.is_dir():
            return hashlib.sha256("\0".join(sorted(os.listdir(path))).encode("utf-8", "surrogateescape")).digest()
        with path.open("rb") as file:
            return hashlib.sha256(file.read()).digest()
    except (OSError, ValueError):
        return b""
