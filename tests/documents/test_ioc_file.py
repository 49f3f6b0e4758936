# SPDX-License-Identifier: Apache-2.0
"""Project files of STM32CubeMX are read as Java reads properties."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.ioc_file import Ioc, read_ioc
from tests.documents.ioc_texts import escaped, ioc_text

PATH = Path("robot.ioc")
TEXTS = st.text(st.characters(codec="ascii", min_codepoint=32, exclude_characters="\x7f"), max_size=12)


def read(text: str) -> Ioc:
    problems = Diagnostics()
    found = read_ioc(PATH, problems, drafts={PATH: text})
    assert found is not None and not list(problems)
    return found


@settings(max_examples=300, deadline=None)
@given(st.dictionaries(TEXTS.filter(bool), TEXTS), st.randoms(), st.sampled_from(["\n", "\r\n", "\r"]), st.data())
def test_all_that_java_writes_is_read(entries: dict[str, str], random: object, end: str, data: st.DataObject) -> None:
    lines = [f"{escaped(key, ' #=:!')}={escaped(value, '#=:!')}" for key, value in entries.items()]
    lines += ["# PB0.Signal=a comment", "", "  ! another one"]
    lines = data.draw(st.permutations(lines))
    found = read(end.join(lines))
    assert {key: entry.value for key, entry in found.entries.items()} == entries
    for entry in found.entries.values():
        written = lines[entry.span.line - 1][entry.span.column - 1 : entry.span.end - 1]
        assert written == escaped(entry.value, "#=:!")


@pytest.mark.parametrize(
    ("line", "key", "value"),
    [
        ("PA13\\ (JTMS/SWDIO).Signal=DEBUG", "PA13 (JTMS/SWDIO).Signal", "DEBUG"),
        ("NVIC.X_IRQn=true\\:0\\:0", "NVIC.X_IRQn", "true:0:0"),
        ("ADC1.Channel-3\\#Regular=3", "ADC1.Channel-3#Regular", "3"),
        ("  key : value ", "key", "value "),
        ("key value", "key", "value"),
        ("key", "key", ""),
        ("a=b\\\n   c", "a", "bc"),
        ("a=\\u0042\\q\\", "a", "Bq"),
        ("a=\\u00", "a", "u00"),
        ("a=1\na=2", "a", "2"),
        ("a=\\u001b[2J", "a", "?[2J"),
        ("=x", "", "x"),
    ],
)
def test_forms_of_a_line(line: str, key: str, value: str) -> None:
    assert {name: entry.value for name, entry in read(line).entries.items()} == {key: value}


def test_a_project_as_cubemx_writes_it() -> None:
    found = read(ioc_text(peripherals=["TIM3"], pins={"PC6": "S_TIM3_CH1"}))
    assert found.value("Mcu.IP3") == "TIM3" and found.value("PC6.Signal") == "S_TIM3_CH1"
    assert found.value("NVIC.HardFault_IRQn").startswith("true:0:0:")
    assert found.value("PC14-OSC32_IN (OSC32_IN).Signal") == "RCC_OSC32_IN"
    assert found.value("nothing") == ""


@settings(max_examples=200, deadline=None)
@given(st.text(max_size=60))
def test_any_text_gives_entries_or_a_message(text: str) -> None:
    problems = Diagnostics()
    found = read_ioc(PATH, problems, drafts={PATH: text.encode("utf-8", "replace").decode("utf-8")})
    assert (found is None) == bool(list(problems))
    for key, entry in found.entries.items() if found is not None else ():
        assert key.isprintable() and entry.value.isprintable() and entry.span.column < entry.span.end
