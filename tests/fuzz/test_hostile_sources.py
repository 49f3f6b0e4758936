# SPDX-License-Identifier: Apache-2.0
"""Sources that are made to be slow to read: EPG reads each in linear time and without recursion.

Every text is put at several places of every form of a model.  A normal run uses 32 KiB of each text, for which
a quadratic algorithm already takes seconds.  A long run uses 1 MiB, for which EPG may take two seconds.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from epg.generator.diagnostics import Diagnostics
from epg.generator.importers import load_model
from tests.doubles.twenty_sim.exports import Export
from tests.fuzz.long_run import LONG
from tests.fuzz.project import TookTooLong, time_limit

SIZE = 1 << 20 if LONG else 1 << 15
SECONDS = 2.0  # of processor time


def _fill(text: str) -> str:
    return text * (SIZE // len(text))


def _count(make: Callable[[int], str]) -> str:
    return "".join(make(number) for number in range(SIZE // len(make(99999))))


TEXTS: dict[str, str] = {
    "open string": '"' + _fill('\\"'),
    "open string, backslash at the end": '"' + _fill('\\"') + "\\",
    "quotes": _fill('"'),
    "open strings in lines": _fill('"a\n'),
    "characters": _fill("'\\'"),
    "comments that open": _fill("/*"),
    "comments that close": _fill("*/"),
    "slashes": _fill("/") + "\n",
    "parentheses": "(" * (SIZE // 2) + ")" * (SIZE // 2),
    "braces": "{" * (SIZE // 2) + "}" * (SIZE // 2),
    "brackets": _fill("["),
    "empty bodies": _fill("{}"),
    "semicolons": _fill(";"),
    "a long name": _fill("a"),
    "blanks": "int x" + _fill(" ") + "b;",
    "lines": _fill("\n"),
    "backslashes": _fill("\\\n"),
    "long heads": _fill("a" * 1990 + "(){}"),
    "heads with initialisers": _fill("a()" + ":" * 1980 + "={}"),
    "heads of types": _fill("struct" + " " * 1980 + "x y{}"),
    "heads with open parentheses": _fill("a(" * 990 + "{}"),
    "heads with many parameters": _fill("f(" + "*a," * 600 + "*b){u[0]=1;}"),
    "methods": _fill("a::" * 600 + "(){}"),
    "one type, many bodies": "struct x " + _fill("{}"),
    "many types": _fill("struct "),
    "classes in classes": _fill("class a{"),
    "classes that do not end": _fill("class a{int b(int);"),
    "classes with bases": _fill("class a:" + "b," * 240 + "{"),
    "variables elsewhere": _fill("extern int a[" + "[" * 290),
    "typedefs that do not end": _fill("typedef a "),
    "a typedef of many words": "typedef " + _fill("a ") + "+;",
    "typedefs": _fill("typedef a b;"),
    "assignments that do not end": _fill("xx_P[0]="),
    "a value in parentheses": "xx_P[0] = " + "(" * (SIZE // 2) + "1" + ")" * (SIZE // 2) + ";",
    "a name that does not end": "xx_P[0] = 1; /*" + _fill(" "),
    "a name with blanks": "xx_P[0] = 1; /* a" + _fill(" ") + "b */",
    "a name with braces": "xx_P[0] = 1; /* a" + _fill("{ ") + " */",
    "a long index": "xx_P[" + _fill("1") + "] = 2;",
    "a long number": "xx_P[0] = " + _fill("9") + ";",
    "an exponent": "xx_P[0] = 1e999;",
    "a long input": "xx_V[0] = u[" + _fill("9") + "];",
    "casts": "xx_P[0] = " + _fill("(a") + ";",
    "lists of names": _fill("input_names[]={"),
    "a list of names": "input_names[]={" + _fill('"a",'),
    "strings in a list": "input_names[]={" + _fill('\\"') + "}",
    "step sizes": _fill("step_size"),
    "step sizes set": _fill("step_size="),
    "calls": _fill("a("),
    "functions that call each other": _count(lambda number: f"f{number}(){{f{number + 1}();}}"),
    "warnings": _fill("#warning x\n"),
    "warnings in functions": _count(lambda number: f"f{number}(){{\n#warning x\n}}\n"),
    "hash signs": _fill("#"),
    "a long macro": "#define a " + _fill("\\\n"),
    "macros of macros": _count(lambda number: f"#define a{number} (a{number + 1}*a{number + 1})\n"),
    "an include with a long name": '#include "' + _fill("a") + 'funcs.h"\n',
    "includes of folders": '#include "../../funcs.h"\n#include ".."\n#include "funcs"\n#include "funcs/funcs.h"\n',
    "arrows": _fill("a->"),
    "dimensions": "int a" + _fill("[1]") + ";",
    "declarations": _count(lambda number: f"int a{number};"),
    "declarators": "int " + _fill("a,") + "b;",
    "stars": "int " + _fill("* ") + "a;",
    "a size in parentheses": "double xx_s[" + "(" * (SIZE // 2) + "1" + ")" * (SIZE // 2) + "];",
    "a product": "double xx_number_of_inputs = " + _fill("9*") + "1;",
    "constructors": _fill("a():"),
    "initialisers": "A::A(){" + _fill("new ") + "}",
    "words in letters of another script": _fill("été_(){}"),
    "escape": _fill("\x1b"),
    "statements outside of functions": _fill("if(x){}else{}"),
}

PLACES = [
    ("write", "xxsubmod.c", "body"),
    ("write", "xxtypes.h", "end"),
    ("write_cpp", "Servo.cpp", "top"),
    ("write_cpp", "common/xxtypes.h", "end"),
    ("write_tokens", "tokens.xml", "DYNAMIC_EQUATIONS"),
    ("write_tokens", "tokens.xml", "INITIALIZE_PARAMETERS"),
]
if LONG:
    PLACES += [
        ("write", "xxsubmod.c", "top"),
        ("write", "xxsubmod.c", "end"),
        ("write_cpp", "Servo.cpp", "body"),
        ("write_tokens", "tokens.xml", "INPUT_NAMES3"),
    ]


@pytest.mark.parametrize(("form", "file", "place"), PLACES, ids=lambda value: str(value))
def test_reading_takes_linear_time(form: str, file: str, place: str, tmp_path: Path) -> None:
    getattr(Export(), form)(tmp_path)
    path = tmp_path / file
    original = path.read_text(encoding="utf-8")
    for name, hostile in TEXTS.items():
        path.write_text(_inserted(original, hostile, place), encoding="utf-8")
        diagnostics = Diagnostics()
        try:
            with time_limit(SECONDS):
                model = load_model(tmp_path, diagnostics)
        except TookTooLong:
            pytest.fail(f"'{name}' in {file} takes longer than {SECONDS} s")
        assert model is not None or diagnostics.has_errors, name


def _inserted(original: str, text: str, place: str) -> str:
    if place == "top":
        return f"{text}\n{original}"
    if place == "end":
        return f"{original}\n{text}"
    if place == "body":
        at = original.index("{", original.index("Calculate")) + 1
    else:
        at = original.index("<![CDATA[", original.index(f'<token name="{place}"')) + len("<![CDATA[")
        text = text.replace("]]>", "]] >").replace("\x1b", "")
    return original[:at] + text + original[at:]


def test_xml_of_many_pieces(tmp_path: Path) -> None:
    """Text between many elements, deeply nested elements, document types and entities."""
    path = tmp_path / "tokens.xml"
    for text in (
        "<tokens>" + _fill("x<b/>") + "</tokens>",
        "<tokens>" + _fill("&#10;x<!---->") + "</tokens>",
        "<tokens>" + _fill("<a>"),
        "<tokens" + _count(lambda number: f' a{number}=""') + "/>",
        '<!DOCTYPE a [<!ENTITY b "b">' + _fill('<!ENTITY c "&b;&b;">') + "]><tokens>&c;</tokens>",
    ):
        path.write_text(text, encoding="utf-8")
        diagnostics = Diagnostics()
        with time_limit(SECONDS):
            assert load_model(tmp_path, diagnostics) is None
        assert diagnostics.has_errors
