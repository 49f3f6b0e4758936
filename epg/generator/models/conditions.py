# SPDX-License-Identifier: Apache-2.0
"""Evaluates conditions of C's preprocessor with the macros of one place; ``preprocessor.py`` goes through the files.

A condition is text.  It is ``"1"`` or ``"0"`` if it depends only on macros that the files or their settings define.
Otherwise it depends on the compiler: then it is an expression of C such as ``defined(_WIN32)``, or :data:`OPEN` if it
cannot be evaluated before the first ``#include``.

>>> # #ifdef _WIN32              condition of the lines below it: defined(_WIN32)
>>> # #if defined(WITH_TABLES)   0, if no file defines WITH_TABLES
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Mapping

from epg.generator.dataclass import dataclass
from epg.generator.models.identifiers import words

YES, NO, OPEN = "1", "0", "?"

_TOKEN = re.compile(r"\s*(?:([A-Za-z_]\w*)|(\d[\da-fA-FxX]*[uUlL]*)|(&&|\|\||[<>=!]=|<<|>>|[-+*/%&|^~!<>?:()]))")
_LEVELS = ["||", "&&", "|", "^", "&", "== !=", "< > <= >=", "<< >>", "+ -", "* / %"]
_PRECEDENCE = {sign: level for level, signs in enumerate(_LEVELS) for sign in signs.split()}
_COMPILER = words(
    """
    _WIN32 _WIN64 WIN32 _MSC_VER _DEBUG __MINGW32__ __MINGW64__ __CYGWIN__ __BORLANDC__ __WATCOMC__ __LCC__ __TINYC__
    __GNUC__ __GNUC_MINOR__ __clang__ __INTEL_COMPILER __ARMCC_VERSION __ICCARM__ __cplusplus __STDC__ __STDC_VERSION__
    __STRICT_ANSI__ __APPLE__ __MACH__ __linux__ __linux linux __unix__ __unix unix __FreeBSD__ __QNX__ __VXWORKS__
    __arm__ __aarch64__ __x86_64__ __x86_64 __amd64__ __i386__ __i386 _M_IX86 _M_X64 __LP64__ _LP64 NDEBUG
    """
)
"""Macros of compilers: a header that is included before all others can ask for them."""
_LIBRARY = re.compile(
    r"_\w*|[A-Z]\w*_(?:MAX|MIN|BIT|DIG|EPSILON)|M_[A-Z0-9_]+|[OSF]_[A-Z]{3,9}|E[A-Z]{2,9}|NULL|EOF|NAN|INFINITY|HUGE_VALF?|errno"
    r"|FLT_(?:RADIX|ROUNDS|EVAL_METHOD)|FE_[A-Z_]+|CLOCK(?:S_PER_SEC|_[A-Z_]+)|SIG(?:[A-Z]{3,4}|USR[12])|std(?:in|out|err)"
    r"|is(?:nan|inf|finite|normal)|signbit|offsetof|assert|alloca|bool|true|false|I|complex|va_copy|RAND_MAX|(?:BIG|LITTLE)_ENDIAN|BYTE_ORDER|PRI[a-zA-Z]\w*|linux|unix|WIN(?:64|NT)"
)
"""Names of macros that compilers or C libraries can define."""
_MOST_REPLACED = 100_000  # macros that are replaced in the conditions of a unit; macros of macros can double each time
_LONGEST = 600  # characters of a condition


def both(first: str, second: str) -> str:
    """The condition that ``first`` and ``second`` are true."""
    if NO in (first, second):
        return NO
    if YES in (first, second) or first == second:
        return second if first == YES else first
    return _joined(first, "&&", second)


def either(first: str, second: str) -> str:
    """The condition that ``first`` or ``second`` is true."""
    if YES in (first, second):
        return YES
    if NO in (first, second) or first == second:
        return second if first == NO else first
    return YES if first == inverse(second) else _joined(first, "||", second)


def inverse(condition: str) -> str:
    """The condition that ``condition`` is false."""
    if condition in (YES, NO, OPEN):
        return {YES: NO, NO: YES, OPEN: OPEN}[condition]
    return condition[1:] if condition[0] == "!" else f"!{condition}"


def _joined(first: str, sign: str, second: str) -> str:
    text = f"({first} {sign} {second})"
    return OPEN if OPEN in (first, second) or len(text) > _LONGEST else text


@dataclass(frozen=True)
class _Macro:
    """A macro: its value, which is None if it is not an expression, and the condition under which it is defined."""

    value: str | None
    when: str


@dataclass(frozen=True)
class _Value:
    """The value of an expression: a number, or None and the text of the expression."""

    number: int | None
    text: str
    unsigned: bool = False  # C then has another result if the number is negative

    @property
    def condition(self) -> str:
        return self.text if self.number is None else YES if self.number else NO


_UNKNOWN = _Value(None, OPEN)


def _number(number: int, unsigned: bool) -> _Value:
    """The value of a calculation.  Not known if it does not fit into the integers of C."""
    fits = abs(number) < 1 << 64 and not (unsigned and number < 0)
    return _Value(number, f"({number}{'u' if unsigned else ''})", unsigned) if fits else _UNKNOWN


class DefinedMacros:
    """The macros that are defined at one place, which :meth:`define` and :meth:`undefine` change."""

    def __init__(self, macros: Mapping[str, str]) -> None:
        self._macros = {name: _Macro(value, YES) for name, value in macros.items()}
        self._left = _MOST_REPLACED

    def when(self, name: str) -> str:
        """The condition under which ``name`` is defined."""
        macro = self._macros.get(name)
        if macro is not None:
            return macro.when
        if name in _COMPILER:
            return f"defined({name})"
        return OPEN if _LIBRARY.fullmatch(name) else NO

    def guards(self, name: str) -> bool:
        """True if a header that asks for ``name`` must be read, because no file has defined this name before."""
        return name not in _COMPILER and self.when(name) == OPEN

    def define(self, name: str, value: str | None, condition: str) -> None:
        """Defines a macro under ``condition``."""
        before = self.when(name) if condition != YES else NO
        known = self._macros.get(name)
        same = before == NO or (known is not None and known.value == value)
        self._macros[name] = _Macro(value if same else None, either(before, condition))

    def undefine(self, name: str, condition: str) -> None:
        """Removes the definition of a macro under ``condition``."""
        known = self._macros.get(name)
        value = known.value if known is not None else None
        self._macros[name] = _Macro(value, both(self.when(name), inverse(condition)))

    def value(self, name: str, hidden: frozenset[str]) -> _Value:
        """The value of a macro in an expression.  ``hidden`` are macros that are being replaced."""
        when = self.when(name)
        macro = self._macros.get(name)
        if when == NO or name in hidden:
            return _Value(0, NO)
        if macro is None:
            return _Value(None, name if name in _COMPILER else OPEN)
        self._left -= 1
        if macro.value is None or self._left < 0:
            return _UNKNOWN
        value = _Expression(macro.value, self, hidden | {name}).value()
        if when == YES or value == _Value(0, NO):
            return value
        return _UNKNOWN if OPEN in (when, value.text) else _Value(None, f"({when} ? {value.text} : 0)")


def condition_of(expression: str, macros: DefinedMacros) -> str:
    """The condition that the expression of an ``#if`` is true."""
    return _Expression(expression, macros).value().condition


class _Expression:
    """The expression of an ``#if``.  Text that is not an expression has the value :data:`_UNKNOWN`."""

    def __init__(self, text: str, table: DefinedMacros, hidden: frozenset[str] = frozenset()) -> None:
        self._tokens = _tokens(text.replace("\\\n", " "))
        self._at = 0
        self._table = table
        self._hidden = hidden

    def value(self) -> _Value:
        if not self._tokens or len(self._tokens) > 400 or len(self._hidden) > 20:
            return _UNKNOWN
        try:
            value = self._choice()
        except (ValueError, RecursionError):
            return _UNKNOWN
        return value if self._at == len(self._tokens) else _UNKNOWN

    def _next(self) -> str:
        if self._at == len(self._tokens):
            raise ValueError("the expression ends too early")
        self._at += 1
        return self._tokens[self._at - 1]

    def _takes(self, token: str) -> bool:
        fits = self._at < len(self._tokens) and self._tokens[self._at] == token
        self._at += fits
        return fits

    def _choice(self) -> _Value:
        """An expression, or ``condition ? first : second``."""
        condition = self._binary(0)
        if not self._takes("?"):
            return condition
        first = self._choice()
        if not self._takes(":"):
            raise ValueError("':' is missing")
        second = self._choice()
        if condition.number is None:
            return _UNKNOWN
        chosen = first if condition.number else second
        unsigned = first.unsigned or second.unsigned
        return _number(chosen.number, unsigned) if unsigned and chosen.number is not None else chosen

    def _binary(self, level: int) -> _Value:
        left = self._unary()
        while self._at < len(self._tokens) and _PRECEDENCE.get(self._tokens[self._at], -1) >= level:
            sign = self._next()
            left = _applied(left, sign, self._binary(_PRECEDENCE[sign] + 1))
        return left

    def _unary(self) -> _Value:
        token = self._next()
        if token == "!":
            return _truth(inverse(self._unary().condition))
        if token in ("-", "+", "~"):
            value = self._unary()
            if value.number is None:
                return _UNKNOWN
            number = {"-": -value.number, "+": value.number, "~": ~value.number}[token]
            return _number(number, value.unsigned)
        if token == "(":
            value = self._choice()
            if not self._takes(")"):
                raise ValueError("')' is missing")
            return value
        if token == "defined":
            return self._defined()
        if token[0].isdigit():
            return _literal(token)
        if not token.isidentifier():
            raise ValueError(f"{token} is not a value")
        if self._at < len(self._tokens) and self._tokens[self._at] == "(":
            return self._call()
        return self._table.value(token, self._hidden)

    def _defined(self) -> _Value:
        inside = self._takes("(")
        name = self._next()
        if not name.isidentifier() or (inside and not self._takes(")")):
            raise ValueError("a name is missing")
        return _truth(self._table.when(name))

    def _call(self) -> _Value:
        """Skips the arguments of a macro.  Its value is not known."""
        depth = 0
        while True:
            token = self._next()
            depth += (token == "(") - (token == ")")
            if depth == 0:
                return _UNKNOWN


def _tokens(text: str) -> list[str]:
    """The tokens of an expression; none if it has other characters than those of an expression."""
    tokens, at = [], 0
    text = text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            return []
        tokens.append(match[1] or match[2] or match[3])
        at = match.end()
    return tokens


def _truth(condition: str) -> _Value:
    """The value of a condition, which is 1 or 0 if the condition is known."""
    return _Value(int(condition), condition) if condition in (YES, NO) else _Value(None, condition)


def _literal(token: str) -> _Value:
    """The value of a number such as ``0x10uL``."""
    digits = token.rstrip("uUlL")
    number = int(digits, 8 if re.fullmatch(r"0[0-7]+", digits) else 0)
    unsigned = "u" in token.lower() or number >= 1 << 63
    return _Value(number, f"{digits}{'u' if unsigned else ''}", unsigned)


def _applied(left: _Value, sign: str, right: _Value) -> _Value:
    """The value of ``left <sign> right``."""
    if sign in _LOGIC:
        return _truth(_LOGIC[sign](left.condition, right.condition))
    a, b = left.number, right.number
    if a is None or b is None:
        return _Value(None, _joined(left.text, sign, right.text))
    unsigned = left.unsigned or right.unsigned
    if unsigned and min(a, b) < 0:
        return _UNKNOWN
    if (sign in ("<<", ">>") and not 0 <= b < 64) or (sign in ("/", "%") and b == 0):
        return _UNKNOWN
    return _number(int(_ARITHMETIC[sign](a, b)), unsigned and sign not in _COMPARISONS)


def _quotient(a: int, b: int) -> int:
    """``a / b``, which C rounds towards zero."""
    return abs(a) // abs(b) * (1 if (a < 0) == (b < 0) else -1)


def _remainder(a: int, b: int) -> int:
    return a - _quotient(a, b) * b


_COMPARISONS = ("==", "!=", "<", ">", "<=", ">=")
_LOGIC = {"&&": both, "||": either}
_ARITHMETIC: dict[str, Callable[[int, int], int]] = {
    "|": operator.or_,
    "^": operator.xor,
    "&": operator.and_,
    "==": operator.eq,
    "!=": operator.ne,
    "<": operator.lt,
    ">": operator.gt,
    "<=": operator.le,
    ">=": operator.ge,
    "<<": operator.lshift,
    ">>": operator.rshift,
    "+": operator.add,
    "-": operator.sub,
    "*": operator.mul,
    "/": _quotient,
    "%": _remainder,
}
