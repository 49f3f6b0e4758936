# SPDX-License-Identifier: Apache-2.0
"""Finds parts of a model that a target cannot run.

Only the code that runs is checked.  Exports also contain code that never runs, and its problems do not matter.
"""

from __future__ import annotations

import bisect
import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from pathlib import Path

from epg.generator.diagnostics import Diagnostics, Note
from epg.generator.models.c_code import KEYWORDS, CFile, Function, function_head
from epg.generator.models.declarations import outside_bodies
from epg.generator.models.identifiers import words
from epg.generator.models.library_types import FILES as FILE_TYPES
from epg.generator.models.library_types import is_declaration, is_of_std, library_uses
from epg.generator.models.link import Linked
from epg.generator.models.tokens import Tokens
from epg.generator.source import Span

FIXED_STEP_METHODS = ("Discrete", "Euler", "RungeKutta2", "RungeKutta4")

STUBS = {
    "Data": "data()",
    "Table": "table()",
    "TimeDelay": "tdelay()",
    "FrequencyEvent": "frequencyevent()",
    "FrequencyEvent1": "frequencyevent()",
    "Event": "event()",
    "EventUp": "eventup()",
    "EventDown": "eventdown()",
    "TimeEvent": "timeevent()",
}
_STUB_NAME = re.compile(rf"(?:XX|YY|[A-Z]\w*?_?)?({'|'.join(sorted(STUBS, key=len, reverse=True))})(?=[a-z_]|$)")
_TRIVIAL_BODY = r"\s*(?:return\s*\(?\s*(?:0(?:\.0*)?|XXFALSE|false)\s*\)?\s*;\s*)?"
_DIRECTIVE = re.compile(r"^[ \t]*#[ \t]*(warning|error)\b[ \t]*([^\n]*)", re.MULTILINE)

_CALLED = re.compile(r"(?<!\w)([A-Za-z_]\w{0,255})\s{0,80}\(", re.ASCII)
_LONGEST_TYPEDEF = 2000
_LONGEST_HEAD = 2000

HEAP = words("malloc calloc realloc free strdup aligned_alloc")
_FILES = words("""
    fopen freopen fclose fread fwrite fscanf fgets fputs fputc fgetc getc putc fprintf fflush fseek ftell rewind
    feof remove rename tmpfile open read write close popen system socket
""")
_PRINTS = words("printf puts putchar")
_TERMINAL = re.compile(
    r"f(?:printf|puts|putc|flush)\s{0,80}\([^;]{0,200}?\bstd(?:err|out)\b|fflush\s{0,80}\(\s{0,80}(?:NULL|0)\s{0,80}\)"
)
_CLOCKS = words("time clock difftime gettimeofday clock_gettime")
_LIBRARY = words("""
    acos asin atan atan2 ceil cos cosh exp fabs floor fmod frexp ldexp log log10 modf pow sin sinh sqrt tan tanh
    cbrt exp2 expm1 log1p log2 hypot round trunc lround llround rint lrint nearbyint fmin fmax fdim copysign fma
    asinh acosh atanh erf erfc tgamma lgamma isnan isinf isfinite isnormal signbit nextafter remainder scalbn
    logb ilogb memcpy memset memmove memcmp memchr strlen strcmp strncmp strcpy strncpy strcat strncat strchr
    strrchr strstr strtol strtoul strtod sprintf snprintf vsnprintf sscanf atoi atof atol abs labs llabs div
    rand srand qsort bsearch exit abort assert defined offsetof va_start va_end va_arg static_assert
""")
ROUNDED = words("""
    acos asin atan atan2 cos cosh exp exp10 fmod log log10 pow sin sinh sqrt tan tanh cbrt exp2 expm1 log1p log2 hypot
    asinh acosh atanh erf erfc tgamma lgamma remainder
""")
"""Functions whose last bits depend on the C library."""

LIBRARY = _LIBRARY | {f"{name}f" for name in _LIBRARY} | HEAP | _FILES | _PRINTS | _CLOCKS
"""Functions of the C library, and some of operating systems."""
_LIBRARY_ALL_CPP = LIBRARY | words("min max swap move forward clamp fill copy begin end size")


def check_method(method: str, span: Span, diagnostics: Diagnostics) -> None:
    """Reports an integration method that has no fixed step, or that EPG does not know."""
    if method not in FIXED_STEP_METHODS:
        message = (
            f"integration method '{method}' has no fixed step" if method else "the model has no integration method"
        )
        hint = "choose Discrete, Euler, Runge Kutta 2 or Runge Kutta 4 in 20-sim and export again"
        diagnostics.error("model-variable-step", span, message, hint=hint)


def check_tokens(tokens: Tokens, diagnostics: Diagnostics) -> None:
    """Reports equations that need a solver, from their numbers in ``tokens.xml``."""
    for name, _, id, what, hint in _SOLVER:
        count = tokens.count(name)
        if count:
            diagnostics.error(id, tokens.span(name), _solver(f"{what} ({name} is {count})"), hint=hint)


_DEPENDENT_HINT = "remove the dependency in 20-sim, for example by merging masses that are rigidly coupled"
_LOOP_HINT = "break the loop in 20-sim, for example with a delay or a state"
_SOLVER = (
    ("NUMBER_DEPSTATES", "dependent state", "model-dependent-states", "dependent states", _DEPENDENT_HINT),
    ("NUMBER_ALGLOOPS", "algebraic loop", "model-algebraic-loop", "algebraic loops", _LOOP_HINT),
    (
        "NUMBER_CONSTRAINTS",
        "constraint",
        "model-constraint",
        "constraints",
        "replace constraint() by an explicit equation in 20-sim",
    ),
)
"""Equations that need a solver: the token with their number, the words of ``#error``, and the parts of our message."""


def check_features(
    linked: Linked,
    roots: Sequence[Function],
    diagnostics: Diagnostics,
    *,
    foreign: bool = False,
    allowed: frozenset[str] = frozenset(),
    compiled: Callable[[CFile, int], bool] = lambda code, offset: True,
) -> frozenset[str]:
    """Reports code reachable from ``roots`` that a target cannot run, and warns of code with unexpected effects.

    Returns the functions in :data:`ROUNDED` that the code calls.

    ``foreign`` code, of FMUs, has no known structure: the compiler checks which of its functions exist and are
    declared.  The code can call the functions in ``allowed``.  ``compiled`` returns False for an offset of a file if
    only some compilers see it.
    """
    reachable = linked.reachable(roots)
    _check_directives(linked, reachable, compiled, diagnostics)
    _check_solver_arrays(linked, diagnostics)
    calls = _Calls(linked, reachable, diagnostics, foreign, allowed)
    causes = _Causes(foreign)
    rounded: frozenset[str] = frozenset()
    for code, function in reachable:
        of_files = causes.look_at_types(code, function)
        for name, start in code.calls(function):
            if name not in calls.known:
                rounded |= rounded_in(f"{name}(")
            if name not in LIBRARY and (is_declaration(code, start) or is_of_std(code, start)):
                continue
            if causes.look_at_call(name, start, code, calls.known):
                continue
            if of_files and name not in calls.known:
                continue  # an operation on the file, which is already reported
            calls.check(name, code, code.file.span(start, start + len(name)))
        _check_new(code, function, diagnostics)
    causes.report(calls, diagnostics)
    calls.report()
    _check_precision(linked, diagnostics)
    macros = (macro.value for code in linked.all for macro in code.macros)
    return rounded | rounded_in(" ".join(macros))


def _check_new(code: CFile, function: Function, diagnostics: Diagnostics) -> None:
    """Reports each ``new`` in a method that runs after the start."""
    if not function.owner or function.name.lstrip("~") == function.owner or function.name == "Initialize":
        return
    for match in re.finditer(r"\bnew\b", code.body(function)):
        start = function.body_start + match.start()
        message = "the model allocates memory while it runs"
        diagnostics.error("model-heap", code.file.span(start, start + 3), message, hint=_HEAP_HINT)


def _check_precision(linked: Linked, diagnostics: Diagnostics) -> None:
    """Warns of an export whose type for numbers has been changed to single precision."""
    for code in linked.headers:
        for match in re.finditer(r"\btypedef\s+(float)\s+\w*Double\b", code.file.code):
            message = (
                "XXDouble is float: the model computes in single precision, so results differ from those of 20-sim"
            )
            span = code.file.span(match.start(1), match.end(1))
            diagnostics.warning("model-single-precision", span, message, hint="change it to double")


def rounded_in(text: str) -> frozenset[str]:
    """The functions in :data:`ROUNDED` that are called in ``text``."""
    called = set(_CALLED.findall(text))
    return frozenset(called | {name.removesuffix("f") for name in called}) & ROUNDED


class _Declarations:
    """The files that define and declare each function."""

    def __init__(self, linked: Linked) -> None:
        self._headers = [header.identifiers for header in linked.headers]
        self._defined: dict[str, set[Path]] = {}  # the files that define each function that is not static
        self._own: dict[Path, set[str]] = {}
        for unit in linked.units:
            for function in unit.functions:
                self._own.setdefault(unit.file.path, set()).add(function.name)
                if not function.static:
                    self._defined.setdefault(function.name, set()).add(unit.file.path)
        self._prototypes: dict[Path, set[str]] = {}

    def elsewhere(self, name: str, code: CFile) -> bool:
        """True if a file other than ``code`` defines the function ``name``, and not as static."""
        return bool(self._defined.get(name, set()) - {code.file.path})

    def in_header(self, name: str) -> bool:
        """True if a header mentions the function ``name``."""
        return any(name in header for header in self._headers)

    def visible(self, name: str, code: CFile) -> bool:
        """True if ``code`` defines or declares the function ``name``, or if a header mentions it."""
        path = code.file.path
        if name in self._own.get(path, ()) or self.in_header(name):
            return True
        if path not in self._prototypes:
            statements = (s for outside in outside_bodies(code) for s in re.split(r"[{}]|(?<=;)", outside))
            declared = (s for s in statements if s.rstrip("; \t\n").endswith(")") and s.endswith(";"))
            self._prototypes[path] = {match[1] for s in declared for match in _CALLED.finditer(s)}
        return name in self._prototypes[path]


_WRITES = tuple(f"calls {name}()" for name in ("fprintf", "fwrite", "fputs", "fputc", "putc", "fflush", "fclose"))


def _prints(name: str, spans: Sequence[Span], diagnostics: Diagnostics) -> None:
    """Warns of the calls of ``name``, a function that prints, at ``spans``."""
    message = f"the model calls {name}(){_count(spans)}: a target does not show its output"
    hint = "remove the call, or bind an output of the model to a topic"
    diagnostics.warning("model-prints", spans[0], message, hint=hint)


def _count(spans: Sequence[Span]) -> str:
    return f" in {len(spans)} places" if spans[1:] else ""


class _Causes:
    """Collects the uses of files and of the heap.  Each of the two is reported by one error for all its uses."""

    def __init__(self, foreign: bool) -> None:
        self._foreign = foreign
        self._files: list[tuple[str, Span]] = []
        self._heap: list[tuple[str, Span]] = []

    def look_at_types(self, code: CFile, function: Function) -> bool:
        """Collects the objects in ``function`` that need files or the heap.  True if there is an object for a file."""
        uses = list(library_uses(code, function))
        files = [use for use in uses if use.name in FILE_TYPES]
        for use in files or uses:
            found = self._files if files else self._heap
            found.append((f"uses std::{use.name}", code.file.span(use.start, use.end)))
        return bool(files)

    def look_at_call(self, name: str, start: int, code: CFile, known: set[str]) -> bool:
        """Collects a call of a function of the C library for files or for the heap.  True if ``name`` is one."""
        if name in known or (name not in HEAP and name not in _FILES) or _TERMINAL.match(code.file.code, start):
            return False
        found = self._heap if name in HEAP else self._files
        found.append((f"calls {name}()", code.file.span(start, start + len(name))))
        return True

    def report(self, calls: _Calls, diagnostics: Diagnostics) -> None:
        """Reports one error for the uses of files, and one for the uses of the heap.

        Foreign code that only writes, and does not open a file, can write to the terminal only: these are ``calls``.
        """
        if self._foreign and self._files and all(text.startswith(_WRITES) for text, _ in self._files):
            for text, span in self._files:
                calls.printed.setdefault(text.removeprefix("calls ").removesuffix("()"), []).append(span)
            self._files = []
        hint = "replace tables in files by equations or parameters in 20-sim"
        if self._foreign or any(text.startswith("uses") for text, _ in self._files):
            hint = "give the model these values as parameters, or as constants in its code"
        for uses, id, why, how in (
            (self._files, "model-file-use", ": a target has no files", hint),
            (self._heap, "model-heap", "", _HEAP_HINT),
        ):
            if uses:
                uses.sort(key=lambda use: not re.search(r"open\(|uses", use[0]))  # the cause of the others comes first
                text, span = uses[0]
                others = sorted({other for other, _ in uses} - {text})
                diagnostics.error(id, span, f"the model {text}{_also(others)}{why}", hint=how)


def _also(uses: Sequence[str]) -> str:
    return f" ({', '.join(use.split()[1] for use in uses[:6])} too)" if uses else ""


_HEAP_HINT = "use arrays of fixed size: a target has no heap after it has started"


class _Calls:
    """Checks the calls in the functions ``reachable``."""

    def __init__(
        self,
        linked: Linked,
        reachable: Sequence[tuple[CFile, Function]],
        diagnostics: Diagnostics,
        foreign: bool,
        allowed: frozenset[str],
    ) -> None:
        self.known = _known_names(linked) | allowed
        self._linked = linked
        self._diagnostics = diagnostics
        self._foreign = foreign
        self._stubs = {
            function.name: (code, function)
            for code, function in reachable
            if _STUB_NAME.match(function.name)
            and re.fullmatch(_TRIVIAL_BODY, code.body(function))
            and function.result != "void"
        }
        self._declarations = _Declarations(linked)
        self.printed: dict[str, list[Span]] = {}  # calls of functions that print
        self._timed: dict[str, list[Span]] = {}  # calls of functions that read the clock
        self._told: set[str] = set()  # the functions reported as undefined or undeclared

    def check(self, name: str, code: CFile, span: Span) -> None:
        """Reports a call of a function that a target does not have, or whose effect differs there."""
        if not self._foreign:
            self._check_declared(name, code, span)
        if name in self._stubs:
            self._report_stub(name, span)
        elif name in self.known or name in self._told:
            return
        elif name in _PRINTS or name in _FILES:
            self.printed.setdefault(name, []).append(span)
        elif name in ("rand", "srand"):
            message = f"the model uses {name}(), whose numbers depend on the C library"
            hint = "use an input port for the noise if results must be the same on host and target"
            self._diagnostics.warning("model-random", span, message, hint=hint)
        elif name in _CLOCKS:
            self._timed.setdefault(name, []).append(span)
        elif not self._foreign and name not in (LIBRARY if code.file.path.suffix == ".c" else _LIBRARY_ALL_CPP):
            self._report_missing(name, span)

    def report(self) -> None:
        """Warns of functions that print or that read the clock, once for each of them."""
        for name, spans in self.printed.items():
            _prints(name, spans, self._diagnostics)
        for name, spans in self._timed.items():
            message = f"the model reads the computer's clock ({name}()){_count(spans)}, which targets do not have"
            hint = "use the time of the simulation" if self._foreign else "use 'time' instead of 'realtime' in 20-sim"
            self._diagnostics.warning("model-real-time", spans[0], message, hint=hint)

    def _check_declared(self, name: str, code: CFile, span: Span) -> None:
        """Reports a call of a function in another C file that no header declares: C assumes that it returns int."""
        if code.file.path.suffix != ".c" or name in self._told or not self._declarations.elsewhere(name, code):
            return
        if not self._declarations.visible(name, code):
            self._told.add(name)
            message = f"'{name}' is called, but no header declares it"
            hint = "include the header that declares it, as in the files that 20-sim exports"
            self._diagnostics.error("model-undeclared", span, message, hint=hint)

    def _report_stub(self, name: str, span: Span) -> None:
        holder, stub = self._stubs[name]
        match = _STUB_NAME.match(name)
        what = STUBS[match[1]] if match else name
        note = Note("this function does nothing and returns 0", holder.file.span(stub.start, stub.start + len(name)))
        hint = f"write the body of '{name}', or avoid {what} in the model"
        message = f"the model uses {what}, which is empty in exports"
        self._diagnostics.error("model-stub", span, message, hint=hint, notes=[note])

    def _report_missing(self, name: str, span: Span) -> None:
        self._told.add(name)
        if re.match(r"XX|YY", name) or name.endswith("Submodel") or self._declarations.in_header(name):
            _undefined(name, span, self._linked, self._diagnostics)
            return
        message = f"'{name}' is called, but it is not part of the export: dll() functions run only inside 20-sim"
        hint = "put a source file that defines it into the model's folder"
        self._diagnostics.error("model-dll", span, message, hint=hint)


def _undefined(name: str, span: Span, linked: Linked, diagnostics: Diagnostics) -> None:
    """Reports a function that no file defines.

    All such functions that one file calls share one error, because they are missing for the same reason.
    """
    message = "is called, but no file of the export defines it"
    hint = "check that all files are there and renamed in the same way, or export the model again"
    hint = f"{linked.looked}; {hint}" if linked.looked else hint
    other = linked.elsewhere.get(name)
    notes = [Note("it is defined here, in the folder of another model", other)] if other else []
    for index, item in enumerate(diagnostics.items):
        told, found, others = item.message.partition(message)
        if found and (item.hint, item.notes, item.span.file) == (hint, tuple(notes), span.file):
            others = f"{others.removesuffix(')') or ' (nor '}{', ' if others else ''}'{name}')"
            diagnostics.items[index] = replace(item, message=f"{told}{message}{others}")
            return
    diagnostics.error("model-incomplete", span, f"'{name}' {message}", hint=hint, notes=notes)


def _known_names(linked: Linked) -> set[str]:
    """The names before a parenthesis that the files define: functions, types, macros, methods, and keywords."""
    known = {function.name for _, function in linked.functions()} | {
        function.owner for _, function in linked.functions()
    }
    known |= linked.macro_names() | KEYWORDS
    for code in linked.all:
        text = code.file.code
        for match in re.finditer(r"\btypedef\b", text):
            end = text.find(";", match.end(), match.end() + _LONGEST_TYPEDEF)
            last = re.search(r"\w+$", text[match.end() : max(end, match.end())].rstrip()[-256:])
            known |= {last[0]} if last else set()
        known |= set(re.findall(r"\}\s{0,80}(\w{1,255})\s{0,80};", text))
        known |= set(re.findall(r"\b(?:class|struct|union|enum)\s+(\w+)", text))
        if code.file.path.suffix.lower() != ".c":
            known |= _inline_functions(text)
    return known


def _inline_functions(text: str) -> set[str]:
    """The functions with a body anywhere in ``text``, including those that a class defines inside its braces."""
    names = set()
    start = 0
    for match in re.finditer(r"[{};]", text):
        if match[0] == "{":
            head = function_head(text[max(start, match.start() - _LONGEST_HEAD) : match.start()])
            if head:
                names.add(head.name)
        start = match.end()
    return names


def _check_directives(
    linked: Linked,
    reachable: Iterable[tuple[CFile, Function]],
    compiled: Callable[[CFile, int], bool],
    diagnostics: Diagnostics,
) -> None:
    """Reports ``#warning`` and ``#error`` of 20-sim's templates in functions that run, or outside functions."""
    running = {function.name for _, function in reachable}
    for code in linked.all:
        starts = [function.body_start for function in code.functions]
        for match in _DIRECTIVE.finditer(code.file.without_comments):
            before = bisect.bisect_right(starts, match.start()) - 1
            holder = code.functions[before] if before >= 0 else None
            if holder and match.start() < holder.body_end and holder.name not in running:
                continue
            if compiled(code, match.start()):
                text = code.file.text[match.start(2) : match.end(2)].strip().strip('"')
                _check_directive(match[1], text, code.file.span(match.start(1), match.end(2)), diagnostics)


def _check_directive(kind: str, text: str, span: Span, diagnostics: Diagnostics) -> None:
    """Reports a ``#warning`` or ``#error`` with ``text``."""
    folded = text.casefold()
    for _, named, id, what, hint in _SOLVER:
        if named in folded:
            diagnostics.error(id, span, _solver(what), hint=hint)
            return
    if "not yet implemented" not in folded and kind == "warning" and text:
        hint = "the code generator or a developer has written this warning: check if it matters, then remove it"
        diagnostics.warning("model-warning", span, f"the export has a warning: {text[:200]}", hint=hint)


def _solver(what: str) -> str:
    return f"the model has {what}, which exported code cannot solve"


_SOLVER_ARRAYS = (
    ("rS", "model-dependent-states", "dependent states", _DEPENDENT_HINT),
    ("aA", "model-algebraic-loop", "algebraic loops or constraints", _LOOP_HINT),
)


def _check_solver_arrays(linked: Linked, diagnostics: Diagnostics) -> None:
    """Reports arrays that exist only if equations need a solver: ``xx_S``, ``xx_r``, ``xx_A``, ``xx_a``."""
    for letters, id, what, hint in _SOLVER_ARRAYS:
        end = rf"_[{letters}](?=\s*\[\s*\d+\s*\]\s*=[^=])"  # fast to find, because it begins with one character
        pattern = re.compile(rf"(?<![\w.])(?:\w+->)?(?:xx|m){end}")
        for code in linked.units:
            match = pattern.search(code.file.code) if re.search(end, code.file.code) else None
            if match:
                span = code.file.span(match.start(), match.end())
                diagnostics.error(id, span, _solver(what), hint=hint)
                break
