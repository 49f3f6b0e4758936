# SPDX-License-Identifier: Apache-2.0
"""Finds parts of an FMU that a target cannot run, in the code that the functions of FMI reach.

EPG gives FMUs memory from an array of fixed size.  An FMU can allocate memory while it starts.  A step can allocate
memory only if it frees it again, because the memory would run out otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.documents.source_file import SourceFile, decode
from epg.generator.documents.text_file import one_line
from epg.generator.importers.fmu.fmu_files import FmuFiles
from epg.generator.importers.fmu.fmu_sources import FmuSources
from epg.generator.models.c_code import KEYWORDS, CFile, Function, parse_code
from epg.generator.models.declarations import declared_names
from epg.generator.models.features import HEAP, LIBRARY, check_features
from epg.generator.models.identifiers import words
from epg.generator.models.link import Linked
from epg.generator.source import Span

#: functions of the heap that EPG supplies to FMUs; the callbacks for memory (FMI 2.0.4, section 2.1.5) call them, too
PROVIDED = frozenset(("malloc", "calloc", "realloc", "free", "strdup"))
_SYSTEM = words("""
    strcasecmp strncasecmp stricmp strtok strtok_r getenv setjmp longjmp vprintf vfprintf vsprintf atexit signal raise
    strspn strcspn strpbrk strerror strcoll perror toupper tolower isalnum isalpha iscntrl isdigit isgraph islower
    isprint ispunct isspace isupper isxdigit tmpnam ctime gmtime localtime mktime strftime fputc fgetpos fsetpos ungetc
    system     strnlen strndup memccpy usleep sleep getpid isatty alloca
""")
"""More functions of C libraries; FMUs declare some of them themselves."""
KNOWN = LIBRARY | _SYSTEM
"""Functions that a C library can have.  If it is not known whether the FMU defines one, a call means that library."""
_LONGEST_PARAMETERS = 5000
_TAKES = re.compile(r"\b(malloc|calloc|realloc|strdup|allocateMemory)\s*\)?\s*\(")
_GIVES_BACK = re.compile(r"\b(?:free|freeMemory)\s*\)?\s*\(")
_IDENTIFIES = re.compile(r"(?i)guid|instantiation_?token")
_TEXT = re.compile(r'[ \t]{1,80}"([^"\\\n]{0,200})"')
_START = """Instantiate InstantiateCoSimulation SetupExperiment EnterInitializationMode ExitInitializationMode
Terminate FreeInstance""".split()
_RUN = (
    """DoStep GetReal GetInteger GetBoolean SetReal SetInteger SetBoolean GetBooleanStatus GetFloat64 GetFloat32
SetFloat64 SetFloat32""".split()
    + [f"{verb}{sign}Int{bits}" for verb in ("Get", "Set") for sign in ("", "U") for bits in (8, 16, 32, 64)]
)


def check_fmu(sources: FmuSources, standard: int, diagnostics: Diagnostics) -> frozenset[str]:
    """Reports code that a target cannot run, and warns of code with unexpected effects.

    Returns the functions that :func:`check_features` returns.
    """
    linked = sources.linked
    running = _named(linked, standard, _RUN)
    starting = _named(linked, standard, _START)
    rounded = check_features(
        linked, [*starting, *running], diagnostics, foreign=True, allowed=PROVIDED, compiled=sources.is_compiled
    )
    taking: list[tuple[str, Span]] = []
    reachable = linked.reachable(running)
    for code, function in reachable:
        body = code.body(function)
        taken = _TAKES.search(body)
        if taken is not None and not _GIVES_BACK.search(body) and not _callers_free(function, reachable):
            start = function.body_start + taken.start(1)
            taking.append((function.name, code.file.span(start, start + len(taken[1]))))
    if taking:
        name, span = taking[0]
        others = f" (also {', '.join(other for other, _ in taking[1:5])})" if taking[1:] else ""
        message = f"'{name}' allocates memory while the model runs, and does not free it{others}"
        hint = f"allocate it in fmi{standard}Instantiate{'CoSimulation' if standard == 3 else ''}, or use an array"
        diagnostics.error("model-heap", span, message, hint=hint)
    return rounded


def _callers_free(function: Function, reachable: list[tuple[CFile, Function]]) -> bool:
    """True if ``function`` returns a pointer, and all functions that call it free memory."""
    if "*" not in function.result:
        return False
    call = re.compile(rf"\b{re.escape(function.name)}\s{{0,80}}\(")
    bodies = [code.body(caller) for code, caller in reachable if caller.name != function.name]
    bodies = [body for body in bodies if call.search(body)]
    return bool(bodies) and all(_GIVES_BACK.search(body) for body in bodies)


def check_complete(sources: FmuSources, files: FmuFiles, standard: int, diagnostics: Diagnostics) -> None:
    """Reports functions that a step or the start calls, that the FMU declares, but that none of its sources defines.

    The linker would report them later.  Calls under a condition that only the compiler knows are not checked.
    """
    linked = sources.linked
    missing: dict[str, Span] = {}
    wanted = _undefined(linked)
    for code, function in linked.reachable(_named(linked, standard, [*_START, *_RUN])) if wanted else ():
        for name, start in code.calls(function):
            if name in wanted and sources.is_compiled(code, start):
                missing.setdefault(name, code.file.span(start, start + len(name)))
    names = [name for name in missing if not any(_has_body(name, code) for code in linked.all)]
    if not names:
        return
    message = f"'{names[0]}' is called, but no source of the FMU defines it{_nor(names)}"
    hint = "export the FMU again, with all its sources"
    place = _unlisted(names[0], sources, files)
    if place is not None:
        hint = f"'{one_line(place)}' defines it, but the FMU does not list it as a source: {hint}"
    diagnostics.error("model-incomplete", missing[names[0]], message, hint=hint)


def _undefined(linked: Linked) -> set[str]:
    """The functions that the FMU declares but does not define, and that no C library has."""
    declared = {name for code in linked.all for name in declared_names(code)}
    known = {function.name for _, function in linked.functions()} | linked.macro_names() | KEYWORDS
    known |= {variable.name for code in linked.all for variable in code.variables}
    return {name for name in declared - known - KNOWN - PROVIDED if not name.startswith(("_", "fmi"))}


def _unlisted(name: str, sources: FmuSources, files: FmuFiles) -> str | None:
    """The file of the FMU that defines the function ``name`` and that is not one of its ``sources``, or None."""
    for place in sorted(files.contents):
        if place.endswith(".c") and place not in sources.codes and name.encode() in files.contents[place]:
            code = parse_code(SourceFile(files.path(place), decode(files.contents[place])))
            if code.definition(name) is not None:
                return place
    return None


def _has_body(name: str, code: CFile) -> bool:
    """True if a function ``name`` has a body, also in a file in which the parser has lost its way."""
    for match in re.finditer(rf"\b{name}\s{{0,80}}\(", code.file.code) if name in code.identifiers else ():
        depth, at = 1, match.end()
        while depth and at < min(len(code.file.code), match.end() + _LONGEST_PARAMETERS):
            depth += {"(": 1, ")": -1}.get(code.file.code[at], 0)
            at += 1
        if re.match(r"\s*\{", code.file.code[at : at + 200]):
            return True
    return False


def _nor(names: list[str]) -> str:
    rest = ", ".join(f"'{name}'" for name in names[1:5])
    return f" (nor {rest}{f' and {len(names) - 5} more' if names[5:] else ''})" if rest else ""


def check_guid(codes: Collection[CFile], guid: str, span: Span, standard: int, diagnostics: Diagnostics) -> None:
    """Reports sources whose identifier differs from the description's: such an FMU would refuse to start.

    ``span`` is the place of the description.  Sources define the identifier as a macro with text, which is ``FMI_GUID``
    in those of 20-sim.  Macros that the code does not use are ignored.  If there are several, for different versions of
    FMI, one of them must be equal.
    """
    identifiers = list(_identifiers(codes))
    if not identifiers or any(text == guid for text, _ in identifiers):
        return
    word = "guid" if standard == 2 else "instantiationToken"
    text, place = identifiers[0]
    message = (
        f"the {word} is '{one_line(guid)[:60]}', but the sources have '{one_line(text)[:60]}': the FMU would not start"
    )
    hint = "the description and the sources come from two exports: export the FMU again"
    diagnostics.error("fmu-guid", span, message, hint=hint, notes=[Note("the sources", place)])


def _identifiers(codes: Collection[CFile]) -> Iterable[tuple[str, Span]]:
    """The texts of the macros for the identifier that the code uses, and their places."""
    used = {name for code in codes for name in code.used}
    used |= {word for code in codes for macro in code.macros for word in re.findall(r"\w+", macro.value)}
    for code in codes:
        for macro in code.macros:
            end = macro.start + len(macro.name)
            match = _TEXT.match(code.file.text, end) if _IDENTIFIES.search(macro.name) else None
            if match is not None and macro.name in used:
                yield match[1], code.file.span(match.start(1), match.end(1))


def uses_heap(codes: Iterable[CFile]) -> bool:
    """True if the sources can allocate memory from the heap."""
    wanted = HEAP | {"allocateMemory"}
    for code in codes:
        in_macros = (word for macro in code.macros for word in re.findall(r"\w+", macro.value))
        if wanted & code.used or not wanted.isdisjoint(in_macros):
            return True
    return False


def _named(linked: Linked, standard: int, names: Iterable[str]) -> list[Function]:
    wanted = {f"fmi{standard}{name}" for name in names}
    return [function for _, function in linked.functions() if function.name in wanted]
