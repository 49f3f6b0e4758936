# SPDX-License-Identifier: Apache-2.0
"""Mutants of C, made of its tokens: comparisons, arithmetic, constants, && and ||, conditions, removed statements.

>>> [mutant.identity.after for mutant in mutants("int f(int a) { return a < 1; }", "f.c")]
['return a <= 1', 'return a < 2']
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator
from dataclasses import dataclass

from .mutant import Identity, Mutant

_TOKEN = re.compile(
    r"""(?P<skipped>\s+|/\*.*?\*/|//[^\n]*|^[ \t]*\#(?:\\\n|[^\n])*)
    |(?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
    |(?P<word>[A-Za-z_]\w*)
    |(?P<number>\.?\d(?:[eEpP][+-]|[\w.])*)
    |(?P<sign><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)""",
    re.DOTALL | re.MULTILINE | re.VERBOSE,
)
SIGNS = {
    "<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "==", "&&": "||", "||": "&&", "+=": "-=", "-=": "+=",
    "/": "*", "%": "/", "<<": ">>", ">>": "<<", "true": "false", "false": "true",
}  # fmt: skip
BINARY = {"+": "-", "-": "+", "|": "&", "&": "|", "*": "/"}
HEADS = ("if", "for", "while", "switch", "else", "do")
KEYWORDS = (*HEADS, "return", "case", "default", "goto", "sizeof", "const", "static", "struct", "break", "continue")


@dataclass(frozen=True)
class Token:
    kind: str
    text: str
    start: int


def mutants(source: str, file: str) -> Iterator[Mutant]:
    """All mutants of the functions in a C file.  Some do not compile."""
    for function, statement in _statements(_tokens(source)):
        words = [token.text for token in statement]
        first, last = (source.count("\n", 0, statement[k].start) + 1 for k in (0, -1))
        for begin, end, new in _changes(statement):
            after = [*words[:begin], *([new] if new else []), *words[end:]]
            start = statement[begin].start
            stop = statement[end - 1].start + len(words[end - 1]) if end > begin else start
            identity = Identity(function, " ".join(words), " ".join(after) or "(removed)")
            changed = f"{source[:start]} {new} {source[stop:]}"
            yield Mutant(identity, file, range(first, last + 1), False, lambda changed=changed: changed)  # type: ignore[misc]


def _tokens(source: str) -> list[Token]:
    found = _TOKEN.finditer(source)
    return [Token(str(m.lastgroup), m.group(), m.start()) for m in found if m.lastgroup != "skipped"]


def _statements(tokens: list[Token]) -> Iterator[tuple[str, list[Token]]]:
    """Each statement in a function (its head, if it has a body), and the function's name."""
    function, depth, parentheses, inner = "", 0, 0, 0
    statement: list[Token] = []
    for token in tokens:
        text = token.text
        parentheses += (text == "(") - (text == ")")
        head = not statement or statement[0].text in HEADS
        if text == "{" and depth == 0:
            function = _function(statement)
        if depth == 0 or not function:
            depth += (text == "{") - (text == "}")
            statement = [] if text in "{};" else [*statement, token]
        elif (text == "{" and not head) or inner:
            inner += (text == "{") - (text == "}")
            statement.append(token)
        elif text in "{}" or (text == ";" and parentheses == 0):
            depth += (text == "{") - (text == "}")
            if statement:
                yield function, statement
            statement = []
        elif text == ":" and statement and statement[0].text in ("case", "default"):
            statement = []
        else:
            statement.append(token)


def _function(tokens: list[Token]) -> str:
    """The name in the head of a function; empty for a struct, an enum or an array."""
    names = [one.text for one, other in itertools.pairwise(tokens) if one.kind == "word" and other.text == "("]
    return names[0] if names and tokens[-1].text == ")" else ""


def _changes(statement: list[Token]) -> Iterator[tuple[int, int, str]]:
    """The tokens from ``begin`` to before ``end``, and the text that replaces them."""
    words = [token.text for token in statement]
    if _removable(statement):
        yield 0, len(statement), ""
    if words[:2] in (["if", "("], ["while", "("]) and not {"&&", "||", "<", ">", "<=", ">=", "==", "!="} & set(words):
        yield 2, 2, "0 =="
    for k, token in enumerate(statement):
        if token.text in SIGNS:
            yield k, k + 1, SIGNS[token.text]
        elif token.text in BINARY and k and _ends_a_value(statement[k - 1]):
            yield k, k + 1, BINARY[token.text]
        elif token.text == "!":
            yield k, k + 1, ""
        elif token.kind == "number":
            yield k, k + 1, _next_number(token.text)


def _removable(statement: list[Token]) -> bool:
    words = [token.text for token in statement]
    if words in (["break"], ["continue"]):
        return True
    if statement[0].kind != "word" or words[0] in KEYWORDS or len(words) < 3 or statement[1].kind == "word":
        return words[0] == "*" and "=" in words
    declares = words[1] == "*" and (statement[2].kind == "word" or words[2] in "*(")
    return not declares


def _ends_a_value(token: Token) -> bool:
    return (token.kind == "word" and token.text not in KEYWORDS) or token.kind == "number" or token.text in (")", "]")


def _next_number(text: str) -> str:
    if re.fullmatch(r"(0[xX][0-9a-fA-F]+|\d+)[uUlL]*", text):
        digits = text.rstrip("uUlL")
        return f"{int(digits, 0) + 1 if digits.lstrip('0') else 1}{text[len(digits) :]}"
    return f"({text} + 1)"
