# SPDX-License-Identifier: Apache-2.0
"""Finds parts of an FMU that a target cannot run, in the code that the functions of FMI reach.

EPG gives FMUs memory from an array of fixed size.  An FMU can allocate memory while it starts.  A step can allocate
memory only if it frees it again, because the memory would run out otherwise.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable

from epg.diagnostics import Diagnostics, Note
from epg.documents.text_file import one_line
from epg.models.c_code import Code, Function
from epg.models.features import HEAP, check_features
from epg.models.link import Linked
from epg.source import Span

#: functions of the heap that EPG supplies to FMUs; the callbacks for memory (FMI 2.0.4, section 2.1.5) call them, too
PROVIDED = frozenset(("malloc", "calloc", "realloc", "free", "strdup"))
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


def check_fmu(linked: Linked, standard: int, diagnostics: Diagnostics) -> frozenset[str]:
    """Reports code that a target cannot run, and warns of code with unexpected effects.

    Returns the functions that :func:`check_features` returns.
    """
    running = _named(linked, standard, _RUN)
    starting = _named(linked, standard, _START)
    rounded = check_features(linked, [*starting, *running], diagnostics, foreign=True, allowed=PROVIDED)
    taking: list[tuple[str, Span]] = []
    for code, function in linked.reachable(running):
        body = code.body(function)
        taken = _TAKES.search(body)
        if taken is not None and not _GIVES_BACK.search(body):
            start = function.body_start + taken.start(1)
            taking.append((function.name, code.file.span(start, start + len(taken[1]))))
    if taking:
        name, span = taking[0]
        others = f" (also {', '.join(other for other, _ in taking[1:5])})" if taking[1:] else ""
        message = f"'{name}' allocates memory while the model runs, and does not free it{others}"
        hint = f"allocate it in fmi{standard}Instantiate{'CoSimulation' if standard == 3 else ''}, or use an array"
        diagnostics.error("model-heap", span, message, hint=hint)
    return rounded


def check_guid(codes: Collection[Code], guid: str, span: Span, standard: int, diagnostics: Diagnostics) -> None:
    """Reports sources whose identifier differs from the description's: such an FMU would refuse to start.

    ``span`` is the place of the description.  Sources define the identifier as a macro with text, which is ``FMI_GUID``
    in those of 20-sim.  Macros that the code does not use are ignored.  If there are several, for different versions of
    FMI, one of them must be equal.
    """
    used = {name for code in codes for name in code.used}
    used |= {word for code in codes for macro in code.macros for word in re.findall(r"\w+", macro.value)}
    found: list[tuple[str, Span]] = []
    for code in codes:
        for macro in code.macros:
            end = macro.start + len(macro.name)
            match = _TEXT.match(code.file.text, end) if _IDENTIFIES.search(macro.name) else None
            if match is not None and macro.name in used:
                found.append((match[1], code.file.span(match.start(1), match.end(1))))
    if not found or any(text == guid for text, _ in found):
        return
    word = "guid" if standard == 2 else "instantiationToken"
    text, place = found[0]
    message = (
        f"the {word} is '{one_line(guid)[:60]}', but the sources have '{one_line(text)[:60]}': the FMU would not start"
    )
    hint = "the description and the sources come from two exports: export the FMU again"
    diagnostics.error("fmu-guid", span, message, hint=hint, notes=[Note("the sources", place)])


def uses_heap(codes: Iterable[Code]) -> bool:
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
