# SPDX-License-Identifier: Apache-2.0
"""Reads the files of an FMU: an unpacked folder, or a ``.fmu``, which is a zip archive.

An archive is read here, but never unpacked.  It can come from an untrusted source.  EPG therefore refuses, before it
uses any contents: names that lead out of the archive, links, encrypted entries, entries with the same name, methods of
compression that FMUs do not use, and contents that are larger than any model.
"""

from __future__ import annotations

import os
import re
import stat
import struct
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import MAX_BYTES
from epg.generator.documents.text_file import ANOTHER_FILE, too_large
from epg.generator.models.folders import FMU_DESCRIPTION
from epg.generator.source import Span

if TYPE_CHECKING:
    import zipfile

DESCRIPTION = FMU_DESCRIPTION
SOURCES = "sources"
SUFFIX = ".fmu"

MAX_ARCHIVE = 512 << 20  # bytes; some FMUs are large, because of binaries for many platforms and tables of data
MAX_ENTRIES = 20_000
MAX_DIRECTORY = 8 << 20  # bytes of the archive's central directory, its list of files
MAX_UNPACKED = 64 << 20  # bytes of the description and the sources together
MAX_DEPTH = 8  # levels of folders below sources/

_STORED, _DEFLATED = 0, 8  # methods of compression: APPNOTE.TXT, 4.4.5; FMI 2.0.4, 2.3, allows only deflate
_METHODS = {9: "deflate64", 12: "bzip2", 14: "LZMA", 20: "Zstandard", 93: "Zstandard", 95: "XZ", 98: "PPMd"}
_END = struct.Struct("<4s4H2LH")  # end of central directory record: APPNOTE.TXT 6.3.10, section 4.3.16
_END64_LOCATOR = b"PK\x06\x07"  # zip64 end of central directory locator: section 4.3.15
_BAD_NAME = r'[\\:*?"<>|;$\[\]]'  # not allowed in names of files on Windows, or in lists of CMake
_RESERVED = r"(?i)(con|prn|aux|nul|com\d|lpt\d)(\..*)?$"


@dataclass(frozen=True)
class FmuFiles:
    """The description and the sources of an FMU, by their names.  Names have ``/`` and are relative to the FMU's top.

    ``root`` is the folder or the archive.  ``binaries`` are the names of the platforms for which it has binaries.
    ``listed`` are the folders whose entries were read, if the FMU is a folder.
    ``outer`` is the folder in the archive that contains everything, with a ``/`` at its end, or empty.
    """

    root: Path
    archive: bool
    contents: Mapping[str, bytes]
    binaries: tuple[str, ...]
    listed: tuple[Path, ...] = ()
    outer: str = ""

    def path(self, name: str) -> Path:
        """The path of a file.  In an archive this path does not exist; it is only for messages to the user."""
        return self.root / f"{self.outer}{name}"

    def on_disk(self, names: Iterable[str]) -> set[Path]:
        """The archive, or the description and the files ``names`` in a folder: the model changes with one of these."""
        return {self.root} if self.archive else {self.path(DESCRIPTION), *map(self.path, names)}

    @property
    def considered(self) -> tuple[Path, ...]:
        """All files in a folder, which can change the model.  Empty for an archive."""
        return () if self.archive else tuple(sorted(map(self.path, self.contents)))


class _Refused(Exception):
    """The FMU cannot be read; the message says why."""

    def __init__(self, message: str, hint: str = "export the FMU again") -> None:
        super().__init__(message)
        self.hint = hint


def is_fmu_folder(folder: Path) -> bool:
    """True if a folder is an unpacked FMU: its description states a version of FMI."""
    try:
        with (folder / DESCRIPTION).open("rb") as file:
            head = file.read(1 << 16)
    except (OSError, ValueError):
        return False
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        head = head.replace(b"\0", b"")
    return re.search(rb"<fmiModelDescription\b[^>]*\bfmiVersion\b", head) is not None


def read_fmu_files(path: Path, diagnostics: Diagnostics) -> FmuFiles | None:
    """The files of the FMU at ``path``.  None if they cannot be read; the reason is reported."""
    try:
        return _folder(path) if path.is_dir() else _archive(path)
    except _Refused as problem:
        diagnostics.error("fmu-unreadable", Span(str(path)), str(problem), hint=problem.hint)
    except OSError as error:
        message = f"cannot read '{path.name}': {error.strerror or error}"
        diagnostics.error("model-unreadable", Span(str(path)), message, hint="check the file's permissions")
    return None


# a folder ------------------------------------------------------------------------------------------------------------


def _folder(root: Path) -> FmuFiles:
    """The description and the sources in the folder of an unpacked FMU."""
    names, listed = _listed(root)
    contents = _contents(root, names)
    if DESCRIPTION not in contents:
        raise _Refused(too_large(DESCRIPTION, MAX_BYTES), ANOTHER_FILE)
    binaries = root / "binaries"
    platforms: list[str] = []
    if binaries.is_dir():
        listed.append(binaries)
        platforms = sorted(entry.name for entry in binaries.iterdir())
    return FmuFiles(root, False, contents, tuple(platforms), tuple(listed))


def _listed(root: Path) -> tuple[list[str], list[Path]]:
    """The names of the description and of all files in ``sources``, and the folders in which they are."""
    names = [DESCRIPTION]
    listed: list[Path] = []
    for folder, folders, files in os.walk(root / SOURCES):
        listed.append(Path(folder))
        inside = Path(folder).relative_to(root)
        folders[:] = sorted(name for name in folders if not name.startswith(".") and len(inside.parts) <= MAX_DEPTH)
        names += [(inside / name).as_posix() for name in sorted(files) if not name.startswith(".")]
        if len(names) > MAX_ENTRIES:
            raise _Refused(f"'{SOURCES}' has more than {MAX_ENTRIES} files", "is this the right folder?")
    return names, listed


def _contents(root: Path, names: list[str]) -> dict[str, bytes]:
    """The contents of the files that can be sources, by their names."""
    contents: dict[str, bytes] = {}
    total = 0
    for name in names:
        path = root / name
        if not path.is_file() or path.stat().st_size > MAX_BYTES:
            continue  # not a source; if the FMU names it as one, an error is reported there
        contents[name] = path.read_bytes()
        total += len(contents[name])
        if total > MAX_UNPACKED:
            raise _Refused(f"'{SOURCES}' is larger than {MAX_UNPACKED >> 20} MiB", "is this the right folder?")
    return contents


# an archive ----------------------------------------------------------------------------------------------------------


def _archive(path: Path) -> FmuFiles:
    """The description and the sources in an archive."""
    import zipfile  # not at the top: the import would slow down every run
    import zlib

    _check_directory(path)
    try:
        with zipfile.ZipFile(path) as archive:
            outer, names = _names(archive)
            wanted = _entries(names)
            contents: dict[str, bytes] = {}
            left = MAX_UNPACKED
            for name, entry in sorted(wanted.items()):
                if entry.file_size > MAX_BYTES:
                    raise _Refused(too_large(name, MAX_BYTES), ANOTHER_FILE)
                left -= entry.file_size
                if left < 0:
                    raise _Refused(f"the FMU's sources are larger than {MAX_UNPACKED >> 20} MiB", ANOTHER_FILE)
                with archive.open(entry) as file:
                    data = file.read(entry.file_size + 1)  # the size that the entry states can be wrong
                if len(data) != entry.file_size:
                    raise _Refused(f"the size of '{name}' in the FMU is wrong")
                contents[name] = data
    except (zipfile.BadZipFile, zlib.error, EOFError, struct.error, OverflowError, ValueError) as error:
        text = str(error).split("\n", 1)[0][:120]
        raise _Refused(f"'{path.name}' is damaged: {text or 'it ends too early'}") from error
    except (NotImplementedError, RuntimeError) as error:
        raise _Refused(f"'{path.name}' has a compression that FMUs must not use", "compress it with deflate") from error
    if DESCRIPTION not in contents:
        raise _Refused(
            f"there is no '{DESCRIPTION}' in the top folder of '{path.name}'", "an FMU is a zip file with this file"
        )
    return FmuFiles(path, True, contents, _platforms(names), outer=outer)


def _check_directory(path: Path) -> None:
    """Refuses an archive that would need much memory and time even before its first entry is read."""
    size = path.stat().st_size
    if size > MAX_ARCHIVE:
        raise _Refused(too_large(path.name, MAX_ARCHIVE), ANOTHER_FILE)
    with path.open("rb") as file:
        file.seek(max(0, size - (1 << 16) - _END.size - 20))
        tail = file.read()
    at = len(tail) - _END.size
    if at < 0 or tail[at : at + 4] != b"PK\5\6" or tail[-2:] != b"\0\0":
        at = tail.rfind(b"PK\5\6")
    if at < 0 or len(tail) - at < _END.size:
        raise _Refused(f"'{path.name}' is not a zip archive", "an FMU is a zip file with 'modelDescription.xml' in it")
    _, _, _, _, count, directory, _, _ = _END.unpack_from(tail, at)
    if tail[max(0, at - 20) : at][:4] == _END64_LOCATOR or count > MAX_ENTRIES or directory > MAX_DIRECTORY:
        raise _Refused(f"'{path.name}' has more than {MAX_ENTRIES} files", ANOTHER_FILE)


def _names(archive: zipfile.ZipFile) -> tuple[str, list[tuple[str, zipfile.ZipInfo]]]:
    """The folder around the FMU, as of :func:`_outer`, and the entries in it, with their names inside the FMU.

    Some tools write ``./`` before a name, and some write ``\\`` in place of ``/``.
    """
    if len(archive.infolist()) > MAX_ENTRIES:  # the number that the end of the archive states can be wrong
        raise _Refused(f"the FMU has more than {MAX_ENTRIES} files", ANOTHER_FILE)
    names = [(re.sub(r"\A(?:\./)+", "", e.orig_filename.replace("\\", "/")), e) for e in archive.infolist()]
    outer = _outer({name for name, _ in names if name})
    return outer, [(name[len(outer) :], entry) for name, entry in names if name and name.startswith(outer)]


def _outer(known: set[str]) -> str:
    """The only folder at the top, with a ``/`` behind it, if it holds the FMU.  Empty if the FMU is at the top itself.

    An FMU that was unpacked and packed again by a file manager is inside such a folder.  Files of the file manager can
    be beside it, such as ``.DS_Store``.  Its name becomes a part of paths, so it must be as safe as names of files.
    """
    tops = {name.partition("/")[0] for name in known if "/" in name and not name.startswith("__MACOSX/")}
    top = tops.pop() if len(tops) == 1 else ""
    if DESCRIPTION in known or f"{top}/{DESCRIPTION}" not in known:
        return ""
    if not _may_be_unpacked(top, [top]):
        raise _Refused(f"the FMU has a folder '{_shown(top)}', which EPG does not unpack")
    return f"{top}/"


def _shown(name: str) -> str:
    return "".join(char if char.isprintable() else "?" for char in name[:80])


def _platforms(names: list[tuple[str, zipfile.ZipInfo]]) -> tuple[str, ...]:
    """The platforms for which the FMU has binaries."""
    parts = (name.rstrip("/").split("/") for name, _ in names)
    found = {part[1][:40] for part in parts if part[0] == "binaries" and len(part) > 1}
    return tuple(sorted({"".join(char for char in name if char.isprintable()) for name in found}))


def _entries(names: list[tuple[str, zipfile.ZipInfo]]) -> dict[str, zipfile.ZipInfo]:
    """The entries of the description and the sources.  Each is complete and correct, and no two are one file."""
    wanted: dict[str, zipfile.ZipInfo] = {}
    seen: set[str] = set()
    for name, entry in names:
        parts = name.rstrip("/").split("/")
        if name.endswith("/") or (name != DESCRIPTION and parts[0] != SOURCES) or len(parts) > MAX_DEPTH:
            continue  # not a part of the model: it is never read
        _check_file(name, parts, entry)
        if name.casefold() in seen:
            raise _Refused(f"the FMU has '{_shown(name)}' twice")
        seen.add(name.casefold())
        _check_packing(_shown(name), entry)
        wanted[name] = entry
    folders = {"/".join(name.split("/")[:depth]) for name in wanted for depth in range(1, name.count("/") + 1)}
    if folders & wanted.keys():
        raise _Refused(f"'{min(folders & wanted.keys())}' in the FMU is both a file and a folder")
    return wanted


def _check_file(name: str, parts: list[str], entry: zipfile.ZipInfo) -> None:
    if not _may_be_unpacked(name, parts):
        raise _Refused(f"the FMU has a file '{_shown(name)}', which EPG does not unpack")
    if stat.S_ISLNK(entry.external_attr >> 16):
        raise _Refused(f"'{_shown(name)}' in the FMU is a link")


def _check_packing(shown: str, entry: zipfile.ZipInfo) -> None:
    if entry.flag_bits & 0x1:
        raise _Refused(f"'{shown}' in the FMU is encrypted", "compress it without a password")
    if entry.compress_type not in (_STORED, _DEFLATED):
        # Other methods can compress a thousand times more, or are not part of every Python.
        method = _METHODS.get(entry.compress_type, f"method {entry.compress_type}")
        raise _Refused(
            f"'{shown}' in the FMU is compressed with {method}, which FMUs must not use", "compress it with deflate"
        )


def _may_be_unpacked(name: str, parts: list[str]) -> bool:
    """True if, on every operating system, a file of this name can be unpacked and stays inside its folder."""
    if not name.isprintable() or re.search(_BAD_NAME, name):
        return False
    return all(
        part not in ("", ".", "..") and part == part.rstrip(". ") and not re.match(_RESERVED, part) and len(part) <= 100
        for part in parts
    )
