# SPDX-License-Identifier: Apache-2.0
"""The conditions under which parts of C files are compiled."""

from __future__ import annotations

import subprocess
from pathlib import Path
from random import Random

import pytest

from epg.generator.documents.source_file import SourceFile
from epg.generator.models.c_code import Include
from epg.generator.models.conditions import NO, OPEN, YES
from epg.generator.models.preprocessor import ConditionalSection, Preprocessor, TooManyFiles, blank, deciding_macros
from tests.models.harness import HAVE_COMPILER


def parts(
    files: dict[str, str], macros: dict[str, str] | None = None, main: str = "main.c"
) -> dict[str, list[ConditionalSection]]:
    """The parts of ``files`` if ``main`` is compiled with ``macros``."""
    sources = {name: SourceFile(Path(name), text) for name, text in files.items()}

    def find(name: str, include: Include, condition: str) -> str | None:
        return include.name if include.name in sources else None

    preprocessor = Preprocessor(sources.__getitem__, find)
    preprocessor.add(main, macros or {})
    return {name: preprocessor.parts(name) for name in preprocessor.names()}


def conditions(text: str, **macros: str) -> dict[str, str]:
    """The condition of each line of ``text`` that is one letter."""
    found = parts({"main.c": text}, macros)["main.c"]
    return {
        text[part.start : part.end].strip(): part.condition for part in found if text[part.start : part.end].strip()
    }


@pytest.mark.parametrize(
    ("condition", "expected"),
    [
        ("defined(A) && A > 2", YES),
        ("defined A && !defined(B)", YES),
        ("B", NO),
        ("A == 3 || X(1)", YES),
        ("X(1)", OPEN),
        ("(A << 2) == 12 && A % 2 == 1 && -7 / 2 == -3", YES),
        ("A ? 0 : 1", NO),
        ("0x10 == 16 && 010 == 8 && 5UL > 4u", YES),
        ("C", YES),  # C is A, A is 3
        ("defined(_WIN32)", "defined(_WIN32)"),
        ("!defined(_WIN32)", "!defined(_WIN32)"),
        ("defined(_WIN32) && B", NO),
        ("defined(_WIN32) && A", "defined(_WIN32)"),
        ("_MSC_VER >= 1400 || defined(__MINGW32__)", "((_MSC_VER >= 1400) || defined(__MINGW32__))"),
        ("_POSIX_VERSION > 1", OPEN),  # a header of the system can define it
        ("INT_MAX == 32767", OPEN),
        ("(~0U) > 0xFFFF", OPEN),  # how large it is depends on the width of the compiler's integers
        ("0u - 1 > 5 || -1 > 0u || (A ? -1 : 0u) > 0", OPEN),
        ("~0 < 0 && 7u - 2 == 5 && (3 < 2u) - 1 < 0", YES),
        ("__GNUC__ > 5u", "(__GNUC__ > 5u)"),
        ("A +", OPEN),
        ("1 / 0", OPEN),
        ("", OPEN),
        ("(" * 3000, OPEN),
    ],
)
def test_values_of_conditions(condition: str, expected: str) -> None:
    text = f"#define A 3\n#define C (A)\n#define X(n) n\n#if {condition}\na\n#else\nb\n#endif\n"
    found = conditions(text)
    assert found["a"] == expected
    assert found["b"] == {YES: NO, NO: YES, OPEN: OPEN}.get(expected, found["b"])


@pytest.mark.parametrize(
    "names",
    [
        "FLT_RADIX FLT_EVAL_METHOD CLOCKS_PER_SEC CLOCK_MONOTONIC SIGINT FE_INVALID FE_DIVBYZERO DBL_MAX",
        "signbit isnormal offsetof assert alloca stdin stdout stderr bool true false I complex",
    ],
)
def test_macros_of_the_library_are_open(names: str) -> None:
    for name in names.split():
        assert conditions(f"#ifdef {name}\na\n#endif\n") == {"a": OPEN}, name
    assert conditions("#ifdef SIGMA\na\n#endif\n#ifdef CLOCK\nb\n#endif\n") == {"a": NO, "b": NO}


def test_branches() -> None:
    text = "#ifdef A\na\n#elif defined(_WIN32)\nb\n#elif B\nc\n#else\nd\n#endif\ne\n"
    windows = "defined(_WIN32)"
    assert conditions(text) == {"a": NO, "b": windows, "c": NO, "d": f"!{windows}", "e": YES}
    assert conditions(text, A="") == {"a": YES, "b": NO, "c": NO, "d": NO, "e": YES}
    assert conditions(text, B="1") == {"a": NO, "b": windows, "c": f"!{windows}", "d": NO, "e": YES}


def test_a_macro_that_is_defined_under_a_condition() -> None:
    text = "#ifdef _WIN32\n#define OURS 1\n#endif\n#ifdef OURS\na\n#endif\n#if OURS\nb\n#endif\n"
    text += "#undef OURS\n#ifdef OURS\nc\n#endif\n"
    found = conditions(text)
    assert (found["a"], found["b"], found["c"]) == ("defined(_WIN32)", "(defined(_WIN32) ? 1 : 0)", NO)


def test_headers() -> None:
    """An include guard counts, a header that is included twice has the parts of both, a comment is not a directive."""
    files = {
        "main.c": '#include "a.h"\n#define WIDE\n#include "t.h"\n#undef WIDE\n#include "t.h"\n#include "a.h"\n',
        "a.h": "#ifndef _A_H\n#define _A_H\nonce\n#endif\n/*\n#ifdef NOT\n*/\nrest\n",
        "t.h": "#ifdef WIDE\nwide\n#else\nnarrow\n#endif\n#ifdef OTHER\nnone\n#endif\n",
    }
    found = parts(files)
    assert [part.condition for part in found["a.h"]] == [YES, YES, YES]
    assert [part.condition for part in found["t.h"]] == [YES, YES, YES, YES, NO, YES]
    (left_out,) = blank(found["t.h"])
    file = SourceFile(Path("t.h"), files["t.h"]).leaving_out((left_out,))
    assert "none" not in file.code and "narrow" in file.code and len(file.code) == len(files["t.h"])


def test_files_that_include_each_other() -> None:
    with pytest.raises(TooManyFiles, match="include each other without end"):
        parts({"main.c": '#include "main.c"\n#include "main.c"\n'})
    found = parts({"main.c": '#ifndef ONCE\n#define ONCE\n#include "main.c"\n#endif\n'})
    assert [part.condition for part in found["main.c"]] == [YES, YES, YES]


GUARDS = {
    "pragma": "#pragma once\n{body}",
    "not-defined": "#if !defined(_{name}_H)\n#define _{name}_H\n{body}#endif\n",
    "with-a-value": "/* a header */\n#ifndef _{name}_H\n#define _{name}_H 1\n{body}#endif /* _{name}_H */\n",
    "not-defined-without-brackets": "#if ! defined _{name}_H\n#pragma once\n#define _{name}_H\n{body}#endif\n",
}


@pytest.mark.parametrize("kind", GUARDS)
def test_guards_of_headers_that_include_each_other(kind: str) -> None:
    files = {
        "main.c": '#include "a.h"\n',
        "a.h": GUARDS[kind].format(name="A", body='#include "b.h"\n'),
        "b.h": GUARDS[kind].format(name="B", body='#include "a.h"\n'),
    }
    found = parts(files)
    assert [part.condition for part in found["a.h"] + found["b.h"]] == [YES] * (2 if kind == "pragma" else 6)


def test_a_default_of_a_macro_is_not_a_guard() -> None:
    """A header that only defines a macro with a value, or more than one group, does not ask if it was read before."""
    default = "#ifndef _WIDTH\n#define _WIDTH 64\n#endif\n"
    for header in (default, f"{default}int x;\n", f"int x;\n{default}", default.replace("#endif", "#else\nx\n#endif")):
        found = parts({"main.c": '#include "a.h"\n', "a.h": header})["a.h"]
        assert found[1].condition == OPEN, header


def test_pragma_once() -> None:
    """A file is read once in each unit, but again if it was read under another condition, or has no such pragma."""
    once = "#pragma once\n#ifdef WIDE\nwide\n#endif\n"
    twice = '#include "a.h"\n#define WIDE\n#include "a.h"\n'
    assert [part.condition for part in parts({"main.c": twice, "a.h": once})["a.h"]] == [YES, NO, YES]
    assert parts({"main.c": twice, "a.h": once.replace("once", "other")})["a.h"][1].condition == YES
    windows = '#ifdef _WIN32\n#include "a.h"\n#endif\n#include "a.h"\n'
    assert parts({"main.c": windows, "a.h": once})["a.h"][0].condition == YES


def test_many_units_may_include_the_same_headers() -> None:
    """Only files that one unit includes are too many; the work of all units has a limit of its own."""
    texts = {f"{n}.h": f"#ifndef H{n}\n#define H{n}\n#endif\n" for n in range(12)}
    texts["main.c"] = "".join(f'#include "{name}"\n' for name in texts)
    texts["long.c"] = "#if A\n#endif\n" * 10_000
    sources = {name: SourceFile(Path(name), text) for name, text in texts.items()}
    preprocessor = Preprocessor(sources.__getitem__, lambda name, include, condition: include.name)
    for _ in range(1700):
        preprocessor.add("main.c", {})
    with pytest.raises(TooManyFiles, match="the FMU includes too many files"):
        Preprocessor(sources.__getitem__, lambda name, include, condition: None, 19_990_000).add("long.c", {})


def test_macros_that_grow_without_end() -> None:
    """30 macros, each twice in the one before, would be replaced a thousand million times."""
    chain = "".join(f"#define A{n} A{n + 1} + A{n + 1}\n" for n in range(30))
    found = conditions(f"{chain}#define A30 1\n#if A0\na\n#endif\nb\n")
    assert found == {"a": OPEN, "b": YES} | {chain.strip() + "\n#define A30 1": YES}


def test_macros_that_decide() -> None:
    assert deciding_macros("#ifdef FMI_COSIMULATION", YES) == ["FMI_COSIMULATION"]
    assert deciding_macros("#if defined(A) || B > 0", YES) == ["A", "B"]
    assert deciding_macros("#if A && B", YES) == []
    assert deciding_macros("#if !defined(MINIMAL)", NO) == ["MINIMAL"]
    assert deciding_macros("#else", NO) == []


@pytest.mark.skipif(not HAVE_COMPILER, reason="there is no C compiler")
def test_the_compiler_sees_the_same_lines(tmp_path: Path) -> None:
    """In random conditions, the compiler keeps the lines whose condition is 1, and none whose condition is 0."""
    random = Random(3)
    names = "A B C D".split()
    kept = left = 0
    for round in range(20):
        lines, depth = [], 0
        for number in range(120):
            name, other = random.choice(names), random.choice(names)
            expression = random.choice(
                [
                    f"defined({name})",
                    f"{name} > {other}",
                    f"!{name} && {other}",
                    f"({name} + 1) * 2 == 4 || !defined {other}",
                ]
            )
            kind = random.choice(["if", "ifdef", "elif", "else", "endif", "define", "undef", "text", "text", "text"])
            if kind in ("if", "ifdef"):
                depth += 1
                lines.append(f"#if {expression}" if kind == "if" else f"#ifdef {name}")
            elif kind in ("elif", "endif") and depth:
                lines.append(f"#elif {expression}" if kind == "elif" else "#endif")
                depth -= kind == "endif"
            elif kind == "define":
                lines.append(f"#undef {name}\n#define {name} {random.randint(0, 3)}")
            elif kind == "undef":
                lines.append(f"#undef {name}")
            else:
                lines.append(f"line_{number}")
        text = "\n".join([*lines, *["#endif"] * depth, ""])
        path = tmp_path / f"{round}.c"
        path.write_text(text)
        done = subprocess.run(["cc", "-E", "-P", path], capture_output=True, text=True, check=True)
        seen = set(done.stdout.split())
        for part in parts({"main.c": text})["main.c"]:
            words = {word for word in text[part.start : part.end].split() if word.startswith("line_")}
            assert part.condition in (YES, NO)
            assert words <= seen if part.condition == YES else words.isdisjoint(seen)
            kept += len(words) if part.condition == YES else 0
            left += len(words) if part.condition == NO else 0
    assert kept > 100 and left > 100
