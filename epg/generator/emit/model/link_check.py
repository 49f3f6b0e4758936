# SPDX-License-Identifier: Apache-2.0
"""Compiles and links the code of a model alone, to find mistakes of its sources before the build.

Only the compiler knows all macros, headers and functions of a target.  Its messages become at most one error for code
that does not compile, and one for functions that are missing, each with a position.  The linked code also shows how
much memory the model needs.
"""

from __future__ import annotations

import os
import re
import struct
import subprocess
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from tempfile import TemporaryDirectory

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.elf_file import program_memory
from epg.generator.documents.object_file import NotAnObjectFile
from epg.generator.source import Span

_ERROR = re.compile(r"^(.+?):(\d+):(?:(\d+):)? (?:fatal )?error: (.+)$", re.MULTILINE)
_UNDEFINED = re.compile(r"undefined (?:reference to|symbol:) [`']?([\w$.]+)")
# With the debug information of -g1; binutils 2.44 adds the section: "control.c:4:(.text+0x9): undefined ...".
_PLACE = re.compile(r"(?:\S*ld\S*: )?(.+):(\d+):(?:\(\S+\):)? undefined")
_ENTRIES = ("init", "step", "stopped", "finite")  # the functions that each library has
_LONGEST = 600  # seconds for one file; then the check is left out
_MOST_SHOWN = 3


@dataclass(frozen=True)
class LinkInputs:
    """A model's sources and how to compile them.

    ``archiver`` makes the library from the object files.  ``sections`` is True if each function has its own section, as
    on microcontrollers: the linker then leaves out functions that are not used, and those that only they use.
    ``ram`` and ``flash`` are the bytes that a program can have, or None if they are not known.  ``span`` is the place
    of the model, for messages without a better one.
    """

    name: str
    compiler: str
    archiver: str
    sections: bool
    flags: tuple[str, ...]
    sources: tuple[Path, ...]
    include_dirs: tuple[Path, ...]
    forced_header: Path
    folder: Path
    ram: int | None
    flash: int | None
    span: Span


@dataclass(frozen=True)
class Memory:
    """The memory that a linked model needs, in bytes."""

    flash: int
    ram: int

    def __str__(self) -> str:
        return f"{_size(self.flash)} of flash and {_size(self.ram)} of RAM"


def check_link(inputs: LinkInputs, diagnostics: Diagnostics) -> Memory | None:
    """The memory that the model needs.  None if that cannot be found, or after an error.

    Without a compiler that works, nothing is checked: CMake reports that.
    """
    with TemporaryDirectory(prefix="link_", dir=inputs.folder) as work:
        objects = [Path(work) / f"{index}.o" for index in range(len(inputs.sources))]
        with ThreadPoolExecutor(max_workers=min(2, os.cpu_count() or 1)) as pool:
            done = list(pool.map(lambda pair: _compile(inputs, *pair), zip(inputs.sources, objects, strict=True)))
        if None in done:
            return None
        outputs = [(source, text) for source, (good, text) in zip(inputs.sources, done, strict=True) if not good]  # type: ignore[misc]
        if outputs:
            _report_compiler(outputs, inputs, diagnostics)
            return None
        return _link(inputs, objects, Path(work), diagnostics)


def _compile(inputs: LinkInputs, source: Path, object_file: Path) -> tuple[bool, str] | None:
    """Compiles a file.  Returns True if it succeeded, and the compiler's messages; None if it could not be started."""
    folders = [f"-I{folder}" for folder in inputs.include_dirs]
    forced = ["-include", str(inputs.forced_header)]
    fixed = ["-std=c11", "-w", "-g1", "-ffp-contract=off", "-fno-lto"]
    fixed += ["-ffunction-sections", "-fdata-sections"] if inputs.sections else []
    return _run([inputs.compiler, *inputs.flags, *fixed, *folders, *forced, "-c", str(source), "-o", str(object_file)])


def _run(command: Sequence[str]) -> tuple[bool, str] | None:
    environment = {**os.environ, "LC_ALL": "C"}  # the messages are read below
    try:
        done = subprocess.run(command, capture_output=True, timeout=_LONGEST, env=environment)
    except (OSError, subprocess.TimeoutExpired):
        return None
    return done.returncode == 0, (done.stdout + done.stderr).decode(errors="replace")


def _report_compiler(outputs: list[tuple[Path, str]], inputs: LinkInputs, diagnostics: Diagnostics) -> None:
    """Reports the first error of each file, as one diagnostic: the files fail for the same reason in most cases."""
    first: dict[str, tuple[Span, list[str]]] = {}
    for source, text in outputs:
        match = _ERROR.search(text)
        message, span = "the compiler stops", Span(str(source))
        if match is not None:
            column = int(match[3] or 1)
            message, span = match[4].strip(), Span(match[1], int(match[2]), column, column + 1)
        first.setdefault(message, (span, []))[1].append(source.name)
    (message, (span, _)), *others = first.items()
    more = f" ({len(outputs)} files do not compile)" if outputs[1:] else ""
    notes = [Note(other, at) for other, (at, _) in others[:_MOST_SHOWN]]
    hint = "the model does not compile for this target: write the macros that its sources need as 'definitions' in a "
    hint += "model.yaml, or export it for microcontrollers"
    diagnostics.error("model-compile", span, f"{message}{more}", hint=hint, notes=notes)


def _link(inputs: LinkInputs, objects: Sequence[Path], work: Path, diagnostics: Diagnostics) -> Memory | None:
    """Links the functions that the library calls, and all that they need.  Reports functions that are missing."""
    program, library = work / "model", work / "model.a"
    archived = _run([inputs.archiver, "rcs", str(library), *map(str, objects)])
    if archived is None or not archived[0]:
        return None
    roots = [f"-Wl,--undefined={inputs.name}_export_{entry}" for entry in _ENTRIES]
    fixed = ["-nostartfiles", f"-Wl,--entry={inputs.name}_export_step", *roots]
    fixed += ["-Wl,--gc-sections"] if inputs.sections else []
    command = [inputs.compiler, *inputs.flags, *fixed, str(library), "-lm", "-o", str(program)]
    done = _run(command)
    if done is None:
        return None
    good, text = done
    missing = _missing(text, inputs)
    if missing:
        names = list(missing)
        message = f"'{names[0]}' is called, but neither a source of the model nor the C library defines it"
        if names[1:]:
            rest = ", ".join(f"'{name}'" for name in names[1:6])
            message += f" (nor {rest}{f' and {len(names) - 6} more' if names[6:] else ''})"
        hint = "export the model again, with all its sources, or without the part that needs this function"
        diagnostics.error("model-incomplete", missing[names[0]], message, hint=hint)
        return None
    if not good:
        return None  # the SDK supplies the functions that are missing
    return _memory(inputs, program, diagnostics)


def _missing(text: str, inputs: LinkInputs) -> dict[str, Span]:
    """The functions that the linker does not find, from its messages, with the places of their calls."""
    missing: dict[str, Span] = {}
    for line in text.splitlines():
        match, place = _UNDEFINED.search(line), _PLACE.match(line)
        if match is not None and not match[1].startswith("_"):  # the SDK supplies those such as _sbrk
            name = match[1].removeprefix(f"{inputs.name}_private_")
            span = _span(place[1], int(place[2]), name) if place is not None else inputs.span
            missing.setdefault(name, span)
    return missing


def _span(file: str, line: int, name: str) -> Span:
    """The position of ``name`` in a line, or of the whole line if a macro has the name."""
    try:
        text = Path(file).read_text(encoding="utf-8", errors="replace").split("\n")[line - 1]
    except (OSError, IndexError):
        return Span(file, line)
    match = re.search(rf"\b{re.escape(name)}\b", text)
    start = match.start() + 1 if match else len(text) - len(text.lstrip()) + 1
    return Span(file, line, start, start + (len(name) if match else max(1, len(text.strip()))))


def _memory(inputs: LinkInputs, program: Path, diagnostics: Diagnostics) -> Memory | None:
    """The memory of the linked model.  Reports a model that does not fit into the RAM or the flash."""
    try:
        flash, ram = program_memory(program.read_bytes())
    except (OSError, NotAnObjectFile, struct.error, IndexError):
        return None
    memory = Memory(flash, ram)
    before = diagnostics.error_count
    smaller = "export a smaller model, or choose another board"
    for title, needed, size, hint in (
        ("RAM", memory.ram, inputs.ram, f"write a smaller 'heap' in model.yaml, {smaller}"),
        ("flash", memory.flash, inputs.flash, smaller),
    ):
        if size is not None and needed > size:
            message = f"the model needs {_size(needed)} of {title}, but a program can have {_size(size)} on this board"
            diagnostics.error("model-too-large", inputs.span, message, hint=hint)
    return memory if diagnostics.error_count == before else None


def _size(size: int) -> str:
    return f"{size / 1024:.1f} KiB" if size < 1 << 20 else f"{size / (1 << 20):.1f} MiB"
