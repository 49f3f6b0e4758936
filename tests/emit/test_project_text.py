# SPDX-License-Identifier: Apache-2.0
"""A user's text in the files of a new project."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from epg.generator.emit.template import environment
from epg.generator.emit.text import ProjectText, line, word


@given(st.text(max_size=40))
def test_a_line_is_one_line_that_ends_no_span_of_code(text: str) -> None:
    found = line(text)
    assert len(found) == len(text)
    assert len(found.splitlines()) <= 1
    assert "`" not in found
    assert found.isprintable()


@given(st.text(max_size=20))
def test_a_word_needs_no_quotes(text: str) -> None:
    if text and text.isascii() and text.replace("_", "a").isalnum():
        assert word(text) == text
    elif not all(char.isascii() and (char.isalnum() or char in "_.+-") for char in text) or not text:
        with pytest.raises(ValueError):
            word(text)


def test_a_value_without_a_filter_is_an_error() -> None:
    template = environment([], ProjectText).from_string("{{ name }}")
    with pytest.raises(TypeError, match="without a filter"):
        template.render(name="a\nb")
