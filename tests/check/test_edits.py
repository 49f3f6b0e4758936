# SPDX-License-Identifier: Apache-2.0
"""The edits that hints propose: where the text to replace is, and when there is none."""

from __future__ import annotations

from dataclasses import replace

import pytest

from epg.edit.applied import apply_edit
from epg.generator.correction import Correction, correction
from epg.generator.diagnostics import Diagnostic, Edit, did_you_mean
from epg.generator.quantity import number_hint
from epg.generator.source import Span


def diagnostic(line: str, marked: str, hint: str) -> Diagnostic:
    """A message about ``marked`` in ``line``, the second line of its file."""
    start = line.index(marked) + 1
    return Diagnostic("id", "error", Span("a.tcf", 2, start, start + len(marked)), "message", hint)


def after(line: str, marked: str, hint: str) -> str | None:
    edit = diagnostic(line, marked, hint).edit(line)
    return edit.within(line) if edit is not None else None


REST = correction("rest", "reset")


@pytest.mark.parametrize(
    ("line", "marked", "hint", "result"),
    [
        ("reset: encoder.rest", "encoder.rest", REST, "reset: encoder.reset"),
        ("{a: 'encoder.rest', b: rest}", "'encoder.rest'", REST, "{a: 'encoder.reset', b: rest}"),
        ("\trest: 1", "rest", REST, "\treset: 1"),
        ('duty: "80%"   # of it', '"80%"', number_hint("80%"), "duty: 0.8   # of it"),
        ("duty: '1_000'", "'1_000'", number_hint("1_000"), "duty: 1000"),
        ("duty: '3'", "'3'", number_hint("3"), "duty: 3"),
        ("counts: 4096 counts", "4096 counts", number_hint("4096 counts"), "counts: 4096"),
        ("clocks: {sys: 125 mhz}", "125 mhz", correction("mhz", "MHz"), "clocks: {sys: 125 MHz}"),
    ],
)
def test_the_word_at_the_position_is_replaced(line: str, marked: str, hint: str, result: str) -> None:
    assert after(line, marked, hint) == result


@pytest.mark.parametrize(
    ("line", "marked", "hint"),
    [
        ("inputs:", "inputs", correction("input", "motor")),  # a part of another word
        ("a: rest.rest", "rest.rest", REST),  # twice
        ("a: motor", "motor", REST),  # the position is that of something else
        ('a: "Supply.volt"', '"Supply.volt"', correction("Supply.volt", "Supply\\volt")),  # an escape in quotes
        ("a: rest", "rest", "write 'reset'"),  # a hint without a proposal
    ],
)
def test_there_is_no_edit(line: str, marked: str, hint: str) -> None:
    assert after(line, marked, hint) is None


def test_a_message_about_something_else_than_its_position_has_no_edit() -> None:
    found = diagnostic("rest:", "rest", REST)
    assert found.edit("rest:") is not None
    assert replace(found, about="inputs.rest").edit("rest:") is None
    assert replace(found, span=Span("a.tcf")).edit("") is None


def test_an_edit_is_made_only_where_the_old_text_is() -> None:
    edit = Edit(Span("a.tcf", 2, 4, 8), "rest", "reset")
    assert apply_edit("x\r\na: rest # old\r\ny", edit) == "x\r\na: reset # old\r\ny"
    assert apply_edit("x\ny\na: rest", edit) is None
    assert apply_edit("x", edit) is None


def test_a_name_is_proposed_if_one_meaning_is_likely() -> None:
    near = did_you_mean("encodr_pan", ["encoder_pan", "encoder_tilt", "motor"])
    assert near == "did you mean 'encoder_pan'?" and isinstance(near, Correction) and near.new == "encoder_pan"
    assert isinstance(did_you_mean("RP2400", ["rp2040"]), Correction)


@pytest.mark.parametrize(
    ("word", "choices", "hint"),
    [
        ("motor_1", ["motor_2", "button"], "did you mean 'motor_2'?"),  # another motor is not a spelling
        ("23", ["3"], "did you mean '3'?"),  # nor is another number
        ("sped: x", ["speed: x"], "did you mean 'speed: x'?"),  # text that YAML reads in another way
        ("pwm_x", ["pwm_y", "button"], "did you mean 'pwm_y'?"),  # nor is another axis
        ("pan_enc", ["pwm_enc", "pin_enc", "pen_enc"], "did you mean 'pin_enc' or 'pen_enc'?"),  # two are equally near
        ("light", ["motor", "button"], "possible: button, motor"),
    ],
)
def test_a_hint_without_a_proposal(word: str, choices: list[str], hint: str) -> None:
    found = did_you_mean(word, choices)
    assert found == hint and not isinstance(found, Correction)
