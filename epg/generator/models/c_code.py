# SPDX-License-Identifier: Apache-2.0
"""Finds the definitions in a file of C or C++, and the names that it uses.

The parser understands as much of the languages as generated code needs, and no more.

>>> # unit = parse_code(SourceFile(path, text))
>>> # [function.name for function in unit.functions]  ->  ['XXInitializeSubmodel', ...]

Conditional compilation is not evaluated: a definition inside ``#ifdef`` counts as a definition, unless the file leaves
out that part (see ``preprocessor.py``).
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping

from epg.generator.dataclass import dataclass
from epg.generator.documents.source_file import C11, SourceFile
from epg.generator.models.identifiers import words
from epg.generator.source import Span

KEYWORDS = C11 | words(
    """
    bool catch class delete explicit false friend mutable namespace new nullptr operator private protected
    public template this throw true try typename using virtual
    """
)

_LONGEST_HEAD = 2000  # characters before a body that are parsed as its declaration
_LONGEST_SIZE = 2000  # characters of a size such as "xx_states_size + 1" after its macros are replaced
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_MACRO = re.compile(
    r"^[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(\([^)\n]*\))?[ \t]*((?:\\\n|[^\n])*)", re.MULTILINE | re.ASCII
)
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"\n]+)"|<([^>\n]+)>)', re.MULTILINE)
_OLD_PARAMETERS = re.compile(
    r"\b([A-Za-z_]\w{0,255})\s{0,80}\(\s{0,80}(?:[A-Za-z_]\w{0,255}\s{0,80},\s{0,80}){0,100}[A-Za-z_]\w{0,255}\s{0,80}\)"
    r"((?:\s{0,80}[A-Za-z_][^;{}=]{0,400};){1,100}\s{0,80})\{",
    re.ASCII,
)
_PARAMETERS = re.compile(r"\(([^()]*)\)")
_CALL = re.compile(r"(?<![\w.>])([A-Za-z_]\w*)\s*\(", re.ASCII)
_DECLARATOR = re.compile(
    r"(\**)\s*(?:const\s+)?([A-Za-z_]\w*)\s*((?:\[[^\]]*\]\s*)*)(?:=\s*(.*))?$", re.DOTALL | re.ASCII
)
_TYPE = re.compile(
    r"\s*((?:(?:static|const|extern|volatile|register|unsigned|signed|long|short|struct|enum|union)\b\s*)*)"
    r"([A-Za-z_]\w*(?:\s*::\s*[A-Za-z_]\w*)*)?",
    re.ASCII,
)
_TYPEDEF = re.compile(r"\btypedef\b([^;{}()]{1,200});")


@dataclass(frozen=True)
class Function:
    """A function with a body.  ``owner`` is the class before ``::``, or empty; ``name`` does not contain it.

    ``start``, ``body_start`` and ``body_end`` are offsets into the text of the file.  The body does not include its
    braces.
    """

    name: str
    owner: str
    parameters: str
    result: str
    static: bool
    start: int
    body_start: int
    body_end: int


@dataclass(frozen=True)
class Variable:
    """A variable that is defined at file scope.  A declaration with ``extern`` is not a definition."""

    name: str
    type: str
    static: bool
    constant: bool
    pointer: bool
    dimensions: str  # "[10 + 1]"; empty for a scalar
    initializer: str
    start: int


@dataclass(frozen=True)
class Macro:
    """A ``#define``.  ``parameters`` is for example "(a, b)", or empty.  ``start`` is the offset of the name."""

    name: str
    parameters: str
    value: str
    start: int


@dataclass(frozen=True)
class Include:
    """An ``#include``.  ``system`` is True if the name is in angle brackets.  ``start`` is the offset of the name."""

    name: str
    system: bool
    start: int


@dataclass(frozen=True)
class CFile:
    """One parsed file."""

    file: SourceFile
    functions: tuple[Function, ...]
    variables: tuple[Variable, ...]
    macros: tuple[Macro, ...]
    includes: tuple[Include, ...]
    identifiers: frozenset[str]  # all identifiers in the file
    used: frozenset[str]  # only those in bodies of functions and definitions of variables, which a linker can need

    def body(self, function: Function) -> str:
        """The body of ``function`` with comments and strings blanked."""
        return self.file.code[function.body_start : function.body_end]

    def calls(self, function: Function) -> Iterator[tuple[str, int]]:
        """The names of the functions that ``function`` calls, each with the offset of the call."""
        for match in _CALL.finditer(self.file.code, function.body_start, function.body_end):
            if match[1] not in KEYWORDS:
                yield match[1], match.start(1)

    def global_names(self) -> set[str]:
        """The functions, the classes of methods, and the variables that the file defines, except static ones."""
        names = {function.owner or function.name for function in self.functions if not function.static}
        return names | {variable.name for variable in self.variables if not variable.static}

    def definition(self, name: str) -> Span | None:
        """The position of the function or variable ``name``; None if the file does not define it."""
        starts = [function.start for function in self.functions if function.name == name]
        starts += [variable.start for variable in self.variables if variable.name == name]
        return self.file.span(starts[0], starts[0] + len(name)) if starts else None


def parse_code(file: SourceFile) -> CFile:
    """Parses ``file``.  Never fails: text that the parser does not understand is skipped."""
    functions: list[Function] = []
    variables: list[Variable] = []
    text = _without_old_parameters(file.code)
    for start, body_start, end in _top_level(text):
        head_end = body_start if body_start >= 0 else end
        if re.match(r"\s*typedef\b", text[start : start + _LONGEST_HEAD]):
            continue
        start = max(start, head_end - _LONGEST_HEAD)
        head = text[start:head_end]
        matched = function_head(head) if body_start >= 0 else None
        if matched and not _opens_type(head):
            functions.append(_function(head, matched, start, body_start, end))
        elif "(" not in head.split("=")[0]:
            variables.extend(_variables(text[start:end], start))
    used = [file.code[function.body_start : function.body_end] for function in functions]
    used += [f"{variable.type} {variable.dimensions} {variable.initializer}" for variable in variables]
    return CFile(
        file,
        tuple(functions),
        tuple(variables),
        tuple(Macro(m[1], m[2] or "", m[3].strip(), m.start(1)) for m in _MACRO.finditer(file.without_comments)),
        tuple(includes(file)),
        frozenset(_IDENTIFIER.findall(file.without_comments)) - KEYWORDS,
        frozenset(_IDENTIFIER.findall(" ".join(used))) - KEYWORDS,
    )


def _without_old_parameters(code: str) -> str:
    """``code`` without the declarations of parameters before a body: ``int f(a) double a; {`` of C before 1989.

    They would look like variables.  Code that was translated from Fortran has them.
    """

    def replacement(match: re.Match[str]) -> str:
        if match[1] in KEYWORDS:
            return match[0]
        return match[0][: match.start(2) - match.start()] + re.sub(r"[^\n]", " ", match[2]) + "{"

    return _OLD_PARAMETERS.sub(replacement, code)


@dataclass(frozen=True)
class Head:
    """The text before the body of a function.  ``start`` is the offset of its name, or of the owner if there is one."""

    name: str
    owner: str
    parameters: str
    start: int


def function_head(head: str) -> Head | None:
    """The name and the parameters in ``head``, the text before a ``{``.  None if the ``{`` does not begin a function.

    Takes linear time; a single regular expression for this would take more.
    """
    if "(" not in head:
        return None
    begin = max(head.rfind(sign) for sign in "=;{}") + 1
    for match in _PARAMETERS.finditer(head, begin):
        at = match.end()
        nested = min((found for found in (head.find("(", at), head.find(")", at)) if found >= 0), default=-1)
        if nested >= 0 and ":" not in head[at:nested]:  # only the initialisers of a constructor have () behind it
            continue
        start, name = _word_before(head, match.start())
        if not name or name in KEYWORDS:
            continue
        if head[start - 1 : start] == "~":
            start, name = start - 1, f"~{name}"
        colons = len(head[:start].rstrip())
        owner = ""
        if head[colons - 2 : colons] == "::":
            owner_start, owner = _word_before(head, colons - 2)
            start = owner_start if owner else start
        return Head(name, owner, match[1].strip(), start)
    return None


def _word_before(text: str, end: int) -> tuple[int, str]:
    """The start and the text of the identifier that ends at ``end``, or at the blanks before it.

    The text is empty if there is no identifier.
    """
    while end > 0 and text[end - 1].isspace():
        end -= 1
    start = end
    while start > 0 and (text[start - 1].isalnum() or text[start - 1] == "_"):
        start -= 1
    word = text[start:end]
    return (start, word) if word.isascii() and not word[:1].isdigit() else (end, "")


def _opens_type(head: str) -> bool:
    """True if the ``{`` after ``head`` begins an initialiser or a type instead of a function."""
    end = head.rstrip()[-300:]
    return re.search(r"=$|\b(?:struct|union|enum|class|namespace)(?:\s+\w+)?$", end) is not None


def typedefs(code: CFile) -> Iterator[tuple[str, str]]:
    """The name and the type of each ``typedef`` that names a plain type: ``("XXDouble", "double")``."""
    for match in _TYPEDEF.finditer(code.file.code):
        words_of_it = match[1].split()
        if len(words_of_it) > 1 and all(_IDENTIFIER.fullmatch(word) for word in words_of_it):
            yield words_of_it[-1], " ".join(words_of_it[:-1])


def integer_value(expression: str, macros: Mapping[str, str]) -> int | None:
    """The value of the size of an array, such as ``xx_states_size`` or ``0 + 6 + 1``.

    None for an expression that is not a sum or product of integers and ``macros``, or whose value is not an ``int``.
    """

    def replacement(match: re.Match[str]) -> str:
        value = macros.get(match[0], match[0])
        return match[0] if value is match[0] or len(value) > 200 else f"({value})"

    for _ in range(8):
        if len(expression) > _LONGEST_SIZE:
            return None
        replaced = _IDENTIFIER.sub(replacement, expression)
        if replaced == expression:
            break
        expression = replaced
    if not re.fullmatch(r"[0-9\s()+*-]+", expression):
        return None
    try:
        # Python's grammar has the same integers and operators, except for numbers that begin with 0.
        value = _sum(ast.parse(re.sub(r"\b0+(?=[0-9])", "", " ".join(expression.split())), mode="eval").body)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return None
    return value if -(1 << 31) <= value < 1 << 31 else None


def _sum(node: ast.expr) -> int:
    """The value of integers with ``+``, ``-`` and ``*``.  Raises ValueError for other expressions."""
    match node:
        case ast.Constant(int(value)):
            return value
        case ast.UnaryOp(ast.UAdd() | ast.USub() as sign, operand):
            return _sum(operand) if isinstance(sign, ast.UAdd) else -_sum(operand)
        case ast.BinOp(left, ast.Add(), right):
            return _sum(left) + _sum(right)
        case ast.BinOp(left, ast.Sub(), right):
            return _sum(left) - _sum(right)
        case ast.BinOp(left, ast.Mult(), right):
            return _sum(left) * _sum(right)
    raise ValueError("another expression")


def includes(file: SourceFile) -> Iterator[Include]:
    """The ``#include`` of a file that name a file, in their order."""
    for match in _INCLUDE.finditer(file.text):
        if file.without_comments[match.start() : match.end()].strip():
            yield Include(match[1] or match[2], match[2] is not None, match.start(1 if match[1] else 2))


def _top_level(code: str) -> Iterator[tuple[int, int, int]]:
    """The start, the start of the body or -1, and the end of each declaration outside braces.

    A body ends a declaration, unless it is an initialiser or a type.  The declarations in ``extern "C" {`` and in a
    namespace count as outside braces.
    """
    start, depth, body_start, head_start = 0, 0, -1, 0
    for match in re.finditer(r"[{};]", code):
        symbol, at = match[0], match.start()
        if symbol == "{":
            if depth == 0:
                end = code[max(start, at - 300) : at].rstrip()
                if end and re.search(r'\bextern\s*"[^"]*"$|\bnamespace(?:\s+\w+)?$', end):
                    start = head_start = at + 1
                    continue
                body_start = at
            depth += 1
        elif symbol == "}":
            if depth == 0:
                start = head_start = at + 1
                continue
            depth -= 1
            if depth == 0:
                head = code[max(start, head_start, body_start - _LONGEST_HEAD) : body_start].rstrip()
                head_start = at + 1  # so that no part of the text is parsed twice
                if not head:
                    start, body_start = at + 1, -1
                    continue
                words_behind = head[max(head.rfind("("), head.rfind(")")) + 1 :]
                if not head.endswith("=") and not re.search(r"\b(?:struct|union|enum|class)\b", words_behind):
                    yield start, body_start, at + 1
                    start, body_start = at + 1, -1
        elif depth == 0:
            is_body = body_start >= 0 and not re.search(r"=\s*$", code[max(start, body_start - 80) : body_start])
            yield start, body_start if is_body else -1, at
            start, body_start = at + 1, -1


def _function(head: str, parsed: Head, start: int, body_start: int, end: int) -> Function:
    before = head[: parsed.start]
    return Function(
        parsed.name,
        parsed.owner,
        parsed.parameters,
        " ".join(before.split()),
        re.search(r"\bstatic\b", before) is not None,
        start + parsed.start,
        body_start + 1,
        end - 1,
    )


def _variables(text: str, offset: int) -> Iterator[Variable]:
    """The variables that one declaration defines.  ``offset`` is the offset of ``text`` in the file."""
    lead = len(text) - len(text.lstrip())
    text, offset = text[lead:], offset + lead
    matched = _TYPE.match(text)
    if not matched or not matched[2] or re.search(r"\b(extern|typedef|using|friend|return|goto)\b", matched[0]):
        return
    if matched[2] in ("class", "template", "public", "private", "protected"):
        return
    name_of_type, at = matched[2], matched.end()
    if re.match(r"\s*(?:[\[=,]|$)", text[at:]) and re.search(r"\b(unsigned|signed|long|short)\b", matched[1]):
        name_of_type, at = matched[1].split()[-1], matched.start(2)  # "unsigned long e": the word after is the name
    rest = text[at:]
    for part, part_at in _split_commas(rest, at):
        part_at += len(part) - len(part.lstrip())
        declared = _DECLARATOR.match(part.strip())
        if declared and declared[2] not in KEYWORDS:
            yield Variable(
                declared[2],
                name_of_type,
                "static" in matched[1].split(),
                "const" in matched[1].split(),
                bool(declared[1]),
                " ".join(declared[3].split()),
                " ".join((declared[4] or "").split()),
                offset + part_at + declared.start(2),
            )


def _split_commas(text: str, offset: int) -> Iterator[tuple[str, int]]:
    """The parts of ``text`` between commas that are not in parentheses, brackets or braces, with their offsets."""
    depth, start = 0, 0
    for index, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            yield text[start:index], offset + start
            start = index + 1
    yield text[start:], offset + start
