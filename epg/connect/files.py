# SPDX-License-Identifier: Apache-2.0
"""The files of a session: read as text, written at once and whole, watched for edits by others.

A file keeps what people see only in their editor: line ends, a byte order mark, its permissions, and the link that
leads to it within the project.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from epg.documents.text_file import MAX_BYTES
from epg.emit.leftovers import lock, temporary_beside

BOM = b"\xef\xbb\xbf"


class Unsavable(Exception):
    """A file is not the one that was read, or cannot be written; the message says which and why."""


@dataclass(frozen=True)
class Snapshot:
    """A text file as it was read: ``data`` None if there was none."""

    path: Path
    data: bytes | None

    @property
    def text(self) -> str | None:
        """The text without a byte order mark; None where there is no file, or what is there is no UTF-8 text."""
        if self.data is None or len(self.data) > MAX_BYTES:
            return None
        try:
            return self.data.decode("utf-8-sig")
        except UnicodeDecodeError:
            return None

    def with_text(self, text: str) -> Snapshot:
        """The same file with another text, marked as it was."""
        mark = BOM if self.data is not None and self.data.startswith(BOM) else b""
        return Snapshot(self.path, mark + text.encode("utf-8"))


def read_snapshot(path: Path) -> Snapshot:
    """The file as it is now.  One that cannot be read counts as missing: loading it says why."""
    try:
        with path.open("rb") as file:
            return Snapshot(path, file.read(MAX_BYTES + 1))
    except (OSError, ValueError):
        return Snapshot(path, None)


def save(before: Snapshot, after: Snapshot, *, project: Path | None = None, anyway: bool = False) -> None:
    """Replaces the file by ``after``, if it is still the one read ``before``: whoever reads it sees one of the two.

    The file that a symbolic link leads to is replaced, not the link, and its permissions stay.  A link must not lead
    out of ``project``, the folder of the project, nor out of the file's own folder if that lies elsewhere or there is
    no project.  Raises :class:`Unsavable`, with the file as it was.
    """
    target = Path(os.path.realpath(before.path))
    _check_links(before.path, target, project)
    if not anyway and read_snapshot(target).data != before.data:
        raise Unsavable(f"'{before.path.name}' was changed by somebody else since it was read")
    assert after.data is not None
    temporary = temporary_beside(target)
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        if target.exists() and not os.access(target, os.W_OK):
            raise Unsavable(f"'{before.path.name}' is write-protected")
        with temporary.open("xb") as file:
            lock(file.fileno())
            file.write(after.data)
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            os.chmod(temporary, target.stat().st_mode & 0o7777)
        os.replace(temporary, target)
    except OSError as error:
        _discard(temporary)
        raise Unsavable(f"cannot write '{before.path.name}': {error.strerror or error}") from error
    except BaseException:
        _discard(temporary)
        raise


def _check_links(path: Path, target: Path, project: Path | None) -> None:
    """Refuses a link that would have a file changed that nobody named."""
    path = Path(os.path.abspath(path))
    inside = project if project is not None and Path(os.path.abspath(project)) in path.parents else path.parent
    if Path(os.path.realpath(inside)) not in target.parents:
        raise Unsavable(
            f"'{path.name}' is a link to '{target}', outside of '{inside}': EPG does not write there; "
            "replace the link by a copy, or name that file itself in CMakeLists.txt"
        )


def _discard(temporary: Path) -> None:
    with suppress(OSError):  # it was not made
        temporary.unlink()


class Watch:
    """Whether any of some files has other contents than before.

    Contents are read only when what the file system says of a file has changed, so asking twice a second costs little.
    """

    def __init__(self, paths: Iterable[Path] = (), read: Iterable[Snapshot] = ()) -> None:
        """``read`` are files of which it is known what was read: a change since then counts."""
        self._known: dict[Path, tuple[tuple[int, ...], bytes]] = {
            path: (_status(path), _digest(path)) for path in paths
        }
        for snapshot in read:
            digest = hashlib.sha256(snapshot.data).digest() if snapshot.data is not None else b""
            self._known[snapshot.path] = ((-1,), digest)

    def newest(self) -> float:
        """When the youngest of the files was changed, in seconds since 1970; 0 where there is none."""
        return max((status[0] * 1e-9 for status, _ in self._known.values() if len(status) > 1), default=0.0)

    def changed(self) -> list[Path]:
        """The files that have changed since they were last asked for, sorted."""
        found = []
        for path, (status, digest) in self._known.items():
            now = _status(path)
            if now == status:
                continue
            contents = _digest(path)
            self._known[path] = (now, contents)
            if contents != digest:
                found.append(path)
        return sorted(found)


def _status(path: Path) -> tuple[int, ...]:
    try:
        found = path.stat()
    except (OSError, ValueError):
        return ()
    return (found.st_mtime_ns, found.st_ctime_ns, found.st_size, found.st_ino)


def _digest(path: Path) -> bytes:
    """What a file contains, or a folder lists; empty where there is nothing."""
    try:
        if path.is_dir():
            return hashlib.sha256("\0".join(sorted(os.listdir(path))).encode("utf-8", "surrogateescape")).digest()
        with path.open("rb") as file:
            return hashlib.sha256(file.read()).digest()
    except (OSError, ValueError):
        return b""
