# SPDX-License-Identifier: Apache-2.0
"""Proofs of the exchange: every interleaving by the model checker spin, real threads by ThreadSanitizer and counting.

Each check must also be able to fail: broken variants of the model, and of ``exchange.c`` itself, must be refused.
"""

from __future__ import annotations

import platform
import re
import subprocess
from pathlib import Path

import pytest

from .program import RUNTIME, SOURCES, THREAD_SANITIZER, compile_program, run_program
from .spin import check_search, needs_spin, spin

MODEL = Path(__file__).resolve().parent / "exchange.pml"
EXCHANGE = RUNTIME / "src" / "control" / "exchange.c"
SECONDS = "2"
# A broken exchange is refused at its first wrong value; the time until then depends on the load of the machine.
PATIENCE = "60"

BROKEN_MODELS = {
    "BROKEN_IGNORES_THE_READER",
    "BROKEN_ONE_BUFFER_PER_PAIR",
    "BROKEN_NEWEST_BEFORE_DATA",
    "BROKEN_PAIR_BEFORE_NEWEST",
    "BROKEN_ANNOUNCES_LATE",
    "BROKEN_COUNT_BEFORE_PAIR",
}


@needs_spin
def test_spin_finds_nothing_wrong_in_any_interleaving(tmp_path: Path) -> None:
    check_search(spin(MODEL, tmp_path), 10_000)


@needs_spin
@pytest.mark.parametrize(
    ("broken", "assertion"),
    [
        ("BROKEN_IGNORES_THE_READER", "one==two"),
        ("BROKEN_ONE_BUFFER_PER_PAIR", "one==two"),
        ("BROKEN_NEWEST_BEFORE_DATA", "one==two"),
        ("BROKEN_ANNOUNCES_LATE", "one==two"),
        ("BROKEN_PAIR_BEFORE_NEWEST", "one>="),
        ("BROKEN_COUNT_BEFORE_PAIR", "before>=expected"),
    ],
)
def test_spin_sees_the_wrong_value_itself(tmp_path: Path, broken: str, assertion: str) -> None:
    assert f"assertion violated ({assertion}" in spin(MODEL, tmp_path, broken, "WITHOUT_UNSHARED")


def test_all_broken_models_are_tried() -> None:
    assert set(re.findall(r"#ifdef (BROKEN_\w+)", MODEL.read_text())) == BROKEN_MODELS


def test_model_and_code_have_the_same_statements() -> None:
    """Loads and stores of control words in the model have the same order as in the C functions."""

    code = EXCHANGE.read_text()
    write = code[code.index("void epg_exchange_write") : code.index("bool epg_exchange_read")]
    read = code[code.index("bool epg_exchange_read") : code.index("bool epg_exchange_take")]
    take = code[code.index("bool epg_exchange_take") :]
    in_code = r"&exchange->(\w+)|(memcpy)"
    assert ["".join(match) for match in re.findall(in_code, write)] == [
        "reading",
        "newest",
        "memcpy",
        "newest",
        "latest",
        "writes",  # stored; the writer loads its own count, which only it changes
        "writes",
    ]
    assert ["".join(match) for match in re.findall(in_code, read)] == [
        "writes",
        "latest",
        "reading",
        "newest",
        "memcpy",
    ]
    assert ["".join(match) for match in re.findall(in_code, take)] == ["writes"]

    model = _without_broken(MODEL.read_text())
    shared = r"\b(reading|latest|writes|newest)\b(?=[ ;\[])|(second)\["
    writer = model[model.index("proctype writer") : model.index("proctype reader")]
    reader = model[model.index("proctype reader") :]
    assert ["".join(match) for match in re.findall(shared, writer)] == [
        "reading",
        "newest",
        "second",
        "newest",
        "latest",
        "writes",
    ]
    assert ["".join(match) for match in re.findall(shared, reader)] == [
        "writes",
        "latest",
        "reading",
        "newest",
        "second",
    ]


def _without_broken(model: str) -> str:
    """The model after the preprocessor, with no macro defined."""
    done = subprocess.run(["gcc", "-E", "-P", "-xc", "-"], input=model, capture_output=True, text=True, check=True)
    return done.stdout


def mutated(folder: Path, old: str, new: str) -> Path:
    """A copy of ``exchange.c`` in which ``old``, which occurs once, is replaced by ``new``."""
    code = EXCHANGE.read_text()
    assert code.count(old) == 1, old
    path = folder / "exchange.c"
    path.write_text(code.replace(old, new))
    return path


IGNORES_THE_READER = (
    "pair = 1U - atomic_load(&exchange->reading)",
    "pair = 1U - atomic_load(&exchange->latest)",
)
ONE_BUFFER_PER_PAIR = ("index = 1U - atomic_load(&exchange->newest[pair])", "index = 0U")
_COPY = "    memcpy(buffer(exchange, pair, index), value, exchange->size);\n"
_NEWEST = "    atomic_store(&exchange->newest[pair], index);\n"
NEWEST_BEFORE_DATA = (_COPY + _NEWEST, _NEWEST + _COPY)
RELAXED = (
    "atomic_store(&exchange->newest[pair], index)",
    "atomic_store_explicit(&exchange->newest[pair], index, memory_order_relaxed)",
)
MUTATIONS = {
    "ignores_the_reader": IGNORES_THE_READER,
    "one_buffer_per_pair": ONE_BUFFER_PER_PAIR,
    "newest_before_data": NEWEST_BEFORE_DATA,
}


def counted(folder: Path, exchange: Path, seconds: str) -> tuple[int, str]:
    program = compile_program(folder / "stress", [SOURCES / "stress.c", exchange], options=["-O2"])
    done = run_program([program, seconds])
    return done.returncode, done.stdout + done.stderr


def test_two_threads_see_no_torn_disordered_or_stale_value(tmp_path: Path) -> None:
    status, report = counted(tmp_path, EXCHANGE, SECONDS)
    assert status == 0, report
    numbers = dict(re.findall(r"(\w+) (\d+)", report))
    assert int(numbers["writes"]) > 10_000
    assert int(numbers["changes"]) > 50, "the threads hardly met"


@pytest.mark.parametrize("mutation", sorted(MUTATIONS))
def test_two_threads_see_a_broken_exchange(tmp_path: Path, mutation: str) -> None:
    status, report = counted(tmp_path, mutated(tmp_path, *MUTATIONS[mutation]), PATIENCE)
    assert status == 1, report


def under_thread_sanitizer(folder: Path, exchange: Path, seconds: str) -> tuple[int, str]:
    """Exit status and report; 66, immediately, if ThreadSanitizer detects an error."""
    options = ["-O1", *THREAD_SANITIZER]
    program = compile_program(
        folder / "races", [SOURCES / "stress.c", exchange], options=options, defines=["RACES_ONLY"]
    )
    environment = {"TSAN_OPTIONS": "halt_on_error=1 exitcode=66"}
    done = run_program([program, seconds], environment=environment)
    if "unexpected memory mapping" in done.stderr:
        # This ThreadSanitizer does not support the address-space randomisation of newer kernels.
        done = run_program(["setarch", platform.machine(), "-R", program, seconds], environment=environment)
    return done.returncode, done.stdout + done.stderr


def test_thread_sanitizer_finds_no_race(tmp_path: Path) -> None:
    status, report = under_thread_sanitizer(tmp_path, EXCHANGE, SECONDS)
    assert status == 0, report


@pytest.mark.parametrize("mutation", [*sorted(MUTATIONS), "relaxed"])
def test_thread_sanitizer_finds_the_race_of_a_broken_exchange(tmp_path: Path, mutation: str) -> None:
    change = RELAXED if mutation == "relaxed" else MUTATIONS[mutation]
    status, report = under_thread_sanitizer(tmp_path, mutated(tmp_path, *change), PATIENCE)
    assert status == 66, report
    assert "data race" in report
