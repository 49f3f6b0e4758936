"""What a file of C or C++ defines and uses: enough of the language for generated code, and no more.

>>> # unit = parse_code(SourceFile(path, text))
>>> # [function.name for function in unit.functions]  ->  ['XXInitializeSubmodel', ...]

Conditional compilation is not evaluated: a definition inside ``#ifdef`` counts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from epg.load.models.identifiers import words
from epg.load.models.source_file import SourceFile

KEYWORDS = words(
    """
    auto break case char const continue default do double else enum extern float for goto if inline int long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while
    bool catch class delete explicit false friend mutable namespace new nullptr operator private protected
    public template this throw true try typename using virtual
    """
)

_LONGEST_HEAD = 2000  # characters of a declaration before its body that are looked at
_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(\([^)\n]*\))?[ \t]*((?:\\\n|[^\n])*)", re.MULTILINE)
_INCLUDE = re.compile(r'^[ \t]*#[ \t]*include[ \t]*(?:"([^"\n]+)"|<([^>\n]+)>)', re.MULTILINE)
_FUNCTION_HEAD = re.compile(r"((?:[A-Za-z_]\w*\s*::\s*)?~?[A-Za-z_]\w*)\s*\(([^()]*)\)[^()=;{}]*(?::[^;{}=]*)?$")
_CALL = re.compile(r"(?<![\w>.])([A-Za-z_]\w*)\s*\(")
_DECLARATOR = re.compile(r"\s*(\**)\s*(?:const\s+)?([A-Za-z_]\w*)\s*((?:\[[^\]]*\]\s*)*)(?:=\s*(.*))?$", re.DOTALL)
_TYPE = re.compile(
    r"\s*((?:(?:static|const|extern|volatile|register|unsigned|signed|long|short|struct|enum|union)\b\s*)*)"
    r"([A-Za-z_]\w*(?:\s*::\s*[A-Za-z_]\w*)*)?"
)


@dataclass(frozen=True)
class Function:
    """A function with a body; ``name`` without, ``owner`` the class before ``::``."""

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
    """A variable at file scope that is defined (not only declared ``extern``)."""

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
    name: str
    parameters: str
    value: str
    start: int


@dataclass(frozen=True)
class Include:
    name: str
    system: bool
    start: int


@dataclass(frozen=True)
class Code:
    """One parsed file."""

    file: SourceFile
    functions: tuple[Function, ...]
    variables: tuple[Variable, ...]
    macros: tuple[Macro, ...]
    includes: tuple[Include, ...]
    identifiers: frozenset[str]  # all
    used: frozenset[str]  # in bodies of functions and definitions of variables: what a linker would look for

    def body(self, function: Function) -> str:
        """The body of ``function`` with comments and strings blanked."""
        return self.file.code[function.body_start : function.body_end]

    def calls(self, function: Function) -> Iterator[tuple[str, int]]:
        """Names that are called in ``function``, and where."""
        for match in _CALL.finditer(self.file.code, function.body_start, function.body_end):
            if match[1] not in KEYWORDS:
                yield match[1], match.start(1)


def parse_code(file: SourceFile) -> Code:
    """Takes ``file`` apart.  Never fails: what is not understood is passed over."""
    functions: list[Function] = []
    variables: list[Variable] = []
    for start, body_start, end in _top_level(file.code):
        head_end = body_start if body_start >= 0 else end
        if re.match(r"\s*typedef\b", file.code[start : start + _LONGEST_HEAD]):
            continue
        start = max(start, head_end - _LONGEST_HEAD)
        head = file.code[start:head_end]
        matched = _FUNCTION_HEAD.search(head) if body_start >= 0 else None
        if matched and not re.search(r"=\s*$|\b(struct|union|enum|class|namespace)\s+\w*\s*$", head):
            functions.append(_function(head, matched, start, body_start, end))
        elif "(" not in head.split("=")[0]:
            variables.extend(_variables(file.code[start:end], start))
    used = [file.code[function.body_start : function.body_end] for function in functions]
    used += [f"{variable.type} {variable.dimensions} {variable.initializer}" for variable in variables]
    return Code(
        file,
        tuple(functions),
        tuple(variables),
        tuple(Macro(m[1], m[2] or "", m[3].strip(), m.start(1)) for m in _MACRO.finditer(file.without_comments)),
        tuple(_includes(file)),
        frozenset(_IDENTIFIER.findall(file.without_comments)) - KEYWORDS,
        frozenset(_IDENTIFIER.findall(" ".join(used))) - KEYWORDS,
    )


def integer_value(expression: str, macros: Mapping[str, str]) -> int | None:
    """The value of a size such as ``xx_states_size`` or ``0 + 6 + 1``; None if it is not that simple."""
    for _ in range(8):
        replaced = _IDENTIFIER.sub(
            lambda match: f"({macros[match[0]]})" if match[0] in macros else match[0], expression
        )
        if replaced == expression:
            break
        expression = replaced
        if len(expression) > 2000:
            return None
    if not re.fullmatch(r"[\d\s()+*-]+", expression) or "**" in expression.replace(" ", ""):
        return None
    try:
        return int(_sum(re.findall(r"\d+|[()+*-]", expression)))
    except (ValueError, IndexError, RecursionError):
        return None


def _sum(tokens: list[str]) -> int:
    def atom() -> int:
        token = tokens.pop(0)
        if token == "(":
            value = total()
            if tokens.pop(0) != ")":
                raise ValueError("unbalanced")
            return value
        if token in "+-":
            return atom() if token == "+" else -atom()
        return int(token)

    def product() -> int:
        value = atom()
        while tokens and tokens[0] == "*":
            tokens.pop(0)
            value *= atom()
        return value

    def total() -> int:
        value = product()
        while tokens and tokens[0] in "+-":
            value += product() if tokens.pop(0) == "+" else -product()
        return value

    value = total()
    if tokens:
        raise ValueError("rest")
    return value


def _includes(file: SourceFile) -> Iterator[Include]:
    for match in _INCLUDE.finditer(file.text):
        if file.without_comments[match.start() : match.end()].strip():
            yield Include(match[1] or match[2], match[2] is not None, match.start(1 if match[1] else 2))


def _top_level(code: str) -> Iterator[tuple[int, int, int]]:
    """Start, start of the body or -1, and end of every declaration outside of braces.

    A body that is no initialiser ends a declaration; ``extern "C" {`` is passed through.
    """
    start, depth, body_start = 0, 0, -1
    for match in re.finditer(r"[{};]", code):
        symbol, at = match[0], match.start()
        if symbol == "{":
            if depth == 0:
                head = code[max(start, at - _LONGEST_HEAD) : at]
                if re.search(r'\bextern\s*"[^"]*"\s*$|\bnamespace(?:\s+\w+)?\s*$', head):
                    start = at + 1
                    continue
                body_start = at
            depth += 1
        elif symbol == "}":
            if depth == 0:
                start = at + 1
                continue
            depth -= 1
            if depth == 0:
                head = code[max(start, body_start - _LONGEST_HEAD) : body_start]
                if not re.search(r"=\s*$|\b(?:struct|union|enum|class)\b[^()]*$", head):
                    yield start, body_start, at + 1
                    start, body_start = at + 1, -1
        elif depth == 0:
            is_body = body_start >= 0 and not re.search(r"=\s*$", code[max(start, body_start - 80) : body_start])
            yield start, body_start if is_body else -1, at
            start, body_start = at + 1, -1


def _function(head: str, matched: re.Match[str], start: int, body_start: int, end: int) -> Function:
    qualified = re.sub(r"\s+", "", matched[1])
    owner, _, name = qualified.rpartition("::")
    before = head[: matched.start()]
    return Function(
        name,
        owner,
        matched[2].strip(),
        " ".join(before.split()),
        re.search(r"\bstatic\b", before) is not None,
        start + matched.start(1),
        body_start + 1,
        end - 1,
    )


def _variables(text: str, offset: int) -> Iterator[Variable]:
    lead = len(text) - len(text.lstrip())
    text, offset = text[lead:], offset + lead
    matched = _TYPE.match(text)
    if not matched or not matched[2] or re.search(r"\b(extern|typedef|using|friend|return|goto)\b", matched[0]):
        return
    if matched[2] in ("class", "template", "public", "private", "protected"):
        return
    name_of_type, at = matched[2], matched.end()
    if re.match(r"\s*(?:[\[=,]|$)", text[at:]) and re.search(r"\b(unsigned|signed|long|short)\b", matched[1]):
        name_of_type, at = matched[1].split()[-1], matched.start(2)  # "unsigned long e": there is no further word
    rest = text[at:]
    for part, part_at in _split_commas(rest, at):
        declared = _DECLARATOR.match(part)
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
    depth, start = 0, 0
    for index, character in enumerate(text):
        depth += (character in "([{") - (character in ")]}")
        if character == "," and depth == 0:
            yield text[start:index], offset + start
            start = index + 1
    yield text[start:], offset + start
