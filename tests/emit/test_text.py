# SPDX-License-Identifier: Apache-2.0
"""A user's text cannot break out of a C string, a comment, an identifier or a CMake argument."""

from __future__ import annotations

import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import jinja2
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from epg.generator.emit.template import FILTERS, environment
from epg.generator.emit.text import (
    CMakeCode,
    Code,
    DevicetreeCode,
    Escaped,
    KconfigCode,
    cmake,
    comment,
    cstring,
    devicetree_string,
    double,
    identifier,
    include,
    kconfig_string,
    nanoseconds,
)


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


@pytest.mark.parametrize("language", FILTERS)
def test_text_of_another_language_is_raw_text(language: type[Escaped]) -> None:
    env = environment([], language)
    assert env.from_string("{{ x }} {{ 'a'|code }} {{ 1 }}").render(x=language("&")) == "& a 1"
    for other in set(FILTERS) - {language}:
        with pytest.raises(TypeError, match="without a filter"):
            env.from_string("{{ x }}").render(x=other("y"))


@pytest.mark.parametrize(
    "template",
    [
        "{{ x ~ y }}",
        "{{ x + y }}",
        "{{ y + x }}",
        "{{ 'a' + x }}",
        "{{ x + 'a' }}",
        "{{ '%s' % y }}",
        "{{ y * 'a' }}",
        "{{ '{}'.format(y) }}",
        "{{ ' '.join([y]) }}",
        "{{ x.join([y]) }}",
        "{{ (x + '%s') % y }}",
        "{{ y|code }}",
        "{{ (y if x else y)|code }}",
        "{{ y|safe }}",
        "{{ y|e }}",
        "{{ y|string }}",
        "{{ [x, y]|join }}",
        "{{ '%s'|format(y) }}",
        "{{ y|replace('a', 'b') }}",
        "{% autoescape false %}{{ y }}{% endautoescape %}",
        "{% macro m() %}a{% endmacro %}{{ m() + y }}",
        "{% macro m(z) %}{{ z }}{% endmacro %}{{ m(y) }}",
        "{% set z %}{{ y }}{% endset %}{{ z }}",
        "{% filter upper %}{{ y }}{% endfilter %}",
        "{% call(z) m() %}{% endcall %}{% macro m() %}{{ caller(y) }}{% endmacro %}{{ y|default(x) }}",
    ],
)
def test_no_template_lets_raw_text_pass(template: str) -> None:
    """``y`` is raw text with characters that HTML would escape: neither it nor its escaped form is in the output."""
    with pytest.raises((TypeError, jinja2.TemplateError)):
        environment([]).from_string(template).render(x=Code("x"), y="<&>")


def test_code_is_joined_to_code_without_change() -> None:
    env = environment([])
    template = "{% macro m() %}a & b < c{% endmacro %}{% set z %}{{ m() }} > {{ x }}{% endset %}{{ z }}{{ x + x }}"
    assert env.from_string(template).render(x=Code("&x")) == "a & b < c > &x&x&x"
    assert Code("&").join([Code("<"), Code(">")]) == "<&>"


@pytest.mark.parametrize("name", ["", "a\nb", "a>b", 'a"b', "a<b", "a\\b", "a//b", "a/*b", "\0"])
def test_names_that_cannot_be_included(name: str) -> None:
    with pytest.raises(ValueError, match="cannot be included"):
        include(name)
    assert include("common/xx model.h") == "common/xx model.h"


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.text(alphabet=st.characters(codec="utf-8", exclude_characters="\0"), max_size=20))
@pytest.mark.skipif(not shutil.which("dtc"), reason="dtc is not installed: sudo apt install device-tree-compiler")
def test_devicetree_strings_hold_any_text(tmp_path: Path, text: str) -> None:
    source = f"/dts-v1/;\n/ {{ x = {devicetree_string(text)}; }};\n"
    blob = subprocess.run(
        ["dtc", "-I", "dts", "-O", "dtb"], input=source.encode("utf-8"), capture_output=True, check=True
    ).stdout
    assert text.encode("utf-8") + b"\0" in blob


def test_kconfig_strings() -> None:
    assert kconfig_string('a"b\\c') == '"a\\"b\\\\c"'
    with pytest.raises(ValueError, match="one line"):
        kconfig_string("a\nCONFIG_B=y")
    assert isinstance(kconfig_string(""), KconfigCode) and isinstance(devicetree_string(""), DevicetreeCode)
    assert isinstance(cmake(""), CMakeCode)


def test_compiled_templates_are_kept_and_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "cache"))
    monkeypatch.setattr("sys.dont_write_bytecode", False)
    (tmp_path / "t.j2").write_text("{{ 1 + 1 }}{{ 'a'|code }}", encoding="utf-8")

    def rendered(language: type[Escaped] = Code) -> str:
        return environment([tmp_path], language).get_template("t.j2").render()

    def kept() -> list[Path]:
        return sorted(path for path in (tmp_path / "cache").rglob("*") if path.is_file())

    assert rendered() == "2a"
    (file,) = kept()
    time = file.stat().st_mtime_ns
    assert rendered() == "2a" and file.stat().st_mtime_ns == time
    data = file.read_bytes()
    for damaged in (b"", data[:-1]):
        file.write_bytes(damaged)
        assert rendered() == "2a"
        assert file.read_bytes() == data
    rendered(KconfigCode)
    assert len(kept()) == 2, "another language compiles to something else"
    (tmp_path / "t.j2").write_text("{{ 1 + 2 }}", encoding="utf-8")
    assert rendered() == "3"
    (tmp_path / "file").write_text("", encoding="utf-8")
    monkeypatch.setenv("EPG_CACHE", str(tmp_path / "file"))
    assert rendered() == "3", "a cache that cannot be written is none"
