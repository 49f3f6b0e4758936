# SPDX-License-Identifier: Apache-2.0
"""Proofs of the latch of stops: every interleaving by the model checker spin, and refused broken variants."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from .program import RUNTIME
from .spin import check_search, needs_spin, spin

MODEL = Path(__file__).resolve().parent / "stop.pml"
STOP = RUNTIME / "src" / "control" / "stop.c"
#: The models in the file, with a number of states that a complete search of each exceeds.
MODELS = {"DIRECT": 100_000, "NAMED": 100_000, "QUEUE": 1_000_000, "EDGE": 1_000_000}
#: Each rule that a broken variant leaves out, and the model that must refuse it.
BROKEN = dict(re.findall(r"(?:ifn?def |defined\()(BROKEN_\w+)\)? /\* (\w+) \*/", MODEL.read_text()))


@needs_spin
@pytest.mark.parametrize("model", MODELS)
def test_spin_finds_nothing_wrong_in_any_interleaving(tmp_path: Path, model: str) -> None:
    check_search(spin(MODEL, tmp_path, model), MODELS[model])


@needs_spin
@pytest.mark.parametrize("rule", sorted(BROKEN))
def test_spin_refuses_a_broken_model(tmp_path: Path, rule: str) -> None:
    assert "assertion violated" in spin(MODEL, tmp_path, BROKEN[rule], rule)


def test_each_broken_model_names_the_model_that_refuses_it() -> None:
    assert set(re.findall(r"BROKEN_[A-Z]\w+", MODEL.read_text())) == set(BROKEN)
    assert set(BROKEN.values()) <= set(MODELS)
    assert len(BROKEN) >= 20


def words_of(name: str) -> list[str]:
    """The words of the latch that a function of ``stop.c`` loads and stores, in its order."""
    code = STOP.read_text()
    begin = re.search(rf"^\S.*\b{name}\([^;]*?\)\n{{", code, re.MULTILINE)
    assert begin is not None
    body = code[begin.end() : code.index("\n}", begin.end())]
    return [
        "".join(match) for match in re.findall(r"latch(?:->|\.)(\w+)|(is_open|gate_open|find_request|cancel)\(", body)
    ]


def test_the_code_has_the_order_of_the_model() -> None:
    """``stop.pml`` has the same order: its inlines, and its control side."""
    assert words_of("cancel") == ["closed", "requests", "moves"]
    assert words_of("epg_stop") == ["cancel", "stopped_by", "pending"]
    assert words_of("epg_gate_open") == ["requests", "closed"]
    assert words_of("epg_gate_poll") == ["is_open", "gate_open"]
    assert words_of("epg_gate_move") == ["moves", "is_open"]
    assert words_of("epg_gate_enable") == ["made", "made", "requests"]
    assert words_of("find_request") == ["is_open", "requests", "acted"]
    assert words_of("epg_stop_take") == ["find_request", "pending", "pending", "guard", "guard", "acted"]
