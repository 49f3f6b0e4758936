"""No text of a user can break out of a C string, a comment, an identifier or a CMake argument."""

from __future__ import annotations

import subprocess
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from epg.emit.text import Code, cmake, comment, cstring, double, environment, identifier, nanoseconds


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(
        st.text(alphabet=st.characters(codec="utf-8", exclude_characters="\0"), max_size=12), min_size=8, max_size=8
    )
)
def test_c_strings_and_comments_hold_any_text(tmp_path: Path, texts: list[str]) -> None:
    lines = ["#include <stdio.h>", "int main(void) {"]
    for text in [*texts, "*/ evil", "a\\", '"; x', "??/", "%s", "/* x", "*", "\\\n", "a *\\\n/ b"]:
        lines += [f"    /* {comment(text)} */", f"    fputs({cstring(text)}, stdout); putchar(0);"]
    source = tmp_path / "x.c"
    source.write_text("\n".join([*lines, "    return 0;", "}", ""]), encoding="utf-8")
    program = tmp_path / "x"
    subprocess.run(["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-trigraphs", "-o", program, source], check=True)
    shown = subprocess.run([program], capture_output=True, check=True).stdout.decode("utf-8").split("\0")
    assert shown[: len(texts)] == texts


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(alphabet=st.characters(codec="utf-8", exclude_characters="\0\r"), max_size=20))
def test_cmake_arguments_hold_any_text(tmp_path: Path, text: str) -> None:
    script = tmp_path / "x.cmake"
    script.write_text(f'set(x {cmake(text)})\nfile(WRITE "{tmp_path}/out" "${{x}}")\n', encoding="utf-8")
    subprocess.run(["cmake", "-P", script], check=True, capture_output=True)
    assert (tmp_path / "out").read_bytes().decode("utf-8") == text.replace(";", "\\;") or (
        (tmp_path / "out").read_text(encoding="utf-8") == text
    )


@pytest.mark.parametrize(
    ("value", "literal"),
    [(1, "1.0"), (Fraction(1, 3), "0.3333333333333333"), (1e300, "1e+300"), (-0.0, "-0.0"), (0.1, "0.1")],
)
def test_doubles_are_exact(value: float, literal: str) -> None:
    assert double(value) == literal
    assert float(double(value)) == float(value)


@pytest.mark.parametrize("value", [float("nan"), float("inf"), True, "1"])
def test_what_is_no_double(value: object) -> None:
    with pytest.raises((TypeError, ValueError)):
        double(value)


def test_times_are_whole_nanoseconds() -> None:
    assert nanoseconds(Fraction(1, 1000)) == "1000000u"
    assert nanoseconds(Fraction(1, 3)) == "333333333u"


def test_identifiers_are_checked() -> None:
    assert identifier("a_1") == "a_1"
    with pytest.raises(ValueError, match="identifier"):
        identifier("a; system()")


def test_a_template_that_prints_raw_text_is_an_error() -> None:
    env = environment([])
    assert env.from_string("{{ x|cstring }}").render(x='a"') == '"a\\""'
    assert env.from_string("{{ x }}").render(x=Code("y")) == "y"
    for value in ("text", 1.5, True, None):
        with pytest.raises(TypeError, match="without a filter"):
            env.from_string("{{ x }}").render(x=value)
