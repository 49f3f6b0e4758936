# SPDX-License-Identifier: Apache-2.0
"""The parts of C that EPG reads."""

from __future__ import annotations

from pathlib import Path

import pytest

from epg.generator.documents.source_file import SourceFile, decode
from epg.generator.models.assignments import exact_number, split_name
from epg.generator.models.c_code import integer_value, parse_code
from epg.generator.models.identifiers import to_identifier, unique_identifiers


def parsed(text: str):  # type: ignore[no-untyped-def]
    return parse_code(SourceFile(Path("a.c"), text))


def test_functions() -> None:
    code = parsed(
        """
        #define ODD(x) { (x)
        extern "C" {
        static int one(void) { if (1) { return 2; } return 3; }
        double (two)(int x);
        XXDouble *three (XXDouble *u, /* } */ XXDouble t)
        { char c = '{'; const char *s = "} \\" {"; return u; }
        }
        A::A(void): b(1), c(2) { }
        A::~A() {}
        """
    )
    assert [(f.owner, f.name, f.static) for f in code.functions] == [
        ("", "one", True),
        ("", "three", False),
        ("A", "A", False),
        ("A", "~A", False),
    ]
    assert code.functions[1].parameters.split() == ["XXDouble", "*u,", "XXDouble", "t"]


def test_variables() -> None:
    code = parsed(
        """
        typedef struct { int x; } t;
        struct s { double y; };
        extern double declared;
        double a = 1.0, *b, c[3] = {1, 2, 3};
        static const int d = 4;
        unsigned long e[2][N + 1];
        XXString names[] = { "a;b", "}" };
        int f(void);
        t g;
        """
    )
    found = {v.name: (v.type, v.static, v.constant, v.pointer, v.dimensions) for v in code.variables}
    assert found.keys() == {"a", "b", "c", "d", "e", "names", "g"}
    assert found["b"] == ("double", False, False, True, "")
    assert found["d"] == ("int", True, True, False, "")
    assert found["e"][4] == "[2][N + 1]"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("10", 10),
        ("N", 6),
        ("N + 1", 7),
        ("0 + 6 + 1 + 16", 23),
        ("(2) * (N)", 12),
        ("sizeof(x)", None),
        ("LOOP", None),
        ("", None),
    ],
)
def test_integer_values(text: str, value: int | None) -> None:
    assert integer_value(text, {"N": "2 * 3", "LOOP": "LOOP + LOOP"}) == value


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1.0", 1),
        ("-0.5", -0.5),
        ("- 2.5e-1", -0.25),
        ("(XXDouble) 3", 3),
        ("1.0f", 1),
        ("1.0 / 4.0", 0.25),
        ("XXTRUE", 1),
        ("1.0 / 0.0", None),
        ("x", None),
        ("1e999999999", None),
        ("__import__('os')", None),
    ],
)
def test_numbers(text: str, value: float | None) -> None:
    assert exact_number(text) == value


@pytest.mark.parametrize(
    ("comment", "name", "unit"),
    [
        ("in", "in", ""),
        ("PID1\\kp {}", "PID1\\kp", ""),
        ("speed of arm {rad/s}", "speed of arm", "rad/s"),
        ("p.e {V}  ", "p.e", "V"),
        ("{m}", "", "m"),
    ],
)
def test_names_and_units(comment: str, name: str, unit: str) -> None:
    assert split_name(comment) == (name, unit)


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("in", "in"),
        ("PID\\kp", "PID_kp"),
        ("a\\\\b", "a_b"),
        ("double", "double_"),
        ("class", "class_"),
        ("2nd", "_2nd"),
        ("_X", "x_X"),
        ("a__b", "a__b"),
        ("", "_"),
        ("größe", "gr_e"),
        ("NULL", "NULL_"),
    ],
)
def test_identifiers(name: str, identifier: str) -> None:
    assert to_identifier(name) == identifier


def test_identifiers_that_collide_get_numbers() -> None:
    assert unique_identifiers(["a\\b", "a_b", "a.b"]) == ["a_b", "a_b_2", "a_b_3"]


def test_encodings() -> None:
    assert decode(b"\xef\xbb\xbfa\r\nb") == "a\nb"
    assert decode("°C".encode("latin-1")) == "°C"
    assert decode("µ".encode("utf-16")) == "µ"


@pytest.mark.parametrize(
    "text", ["{" * 5000, "(" * 5000, "a(" * 5000, "/*" * 5000, '"' * 5001, "x = {" * 3000, "::" * 5000]
)
def test_hostile_text_takes_no_time(text: str) -> None:
    parsed(text)
