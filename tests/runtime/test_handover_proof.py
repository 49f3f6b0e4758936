# SPDX-License-Identifier: Apache-2.0
"""Proofs of the handover as of the exchange: every interleaving by spin, real threads, and refused broken variants."""

from __future__ import annotations

import platform
import re
import shutil
from pathlib import Path

import pytest

from .program import RUNTIME, SOURCES, THREAD_SANITIZER, compile_program, run_program
from .spin import check_search, needs_spin, spin

MODEL = Path(__file__).resolve().parent / "handover.pml"
HANDOVER = RUNTIME / "include" / "epg" / "handover.h"
STRESS = SOURCES / "handover_stress.c"
PATIENCE = "1000000"  # rounds: a broken handover ends at its first wrong block

BROKEN_MODELS = {
    "BROKEN_GIVER_DOES_NOT_ASK",
    "BROKEN_TAKER_DOES_NOT_ASK",
    "BROKEN_GIVEN_BEFORE_WRITTEN",
    "BROKEN_RETURNED_BEFORE_ANSWERED",
}
MUTATIONS = {
    "the giver's question is relaxed": (
        "return atomic_load(&handover->returned) == atomic_load(&handover->given);",
        "return atomic_load_explicit(&handover->returned, memory_order_relaxed) == atomic_load(&handover->given);",
    ),
    "given without order": (
        "atomic_store(&handover->given, atomic_load(&handover->given) + 1U);",
        "atomic_store_explicit(&handover->given, atomic_load(&handover->given) + 1U, memory_order_relaxed);",
    ),
    "returned without order": (
        "atomic_store(&handover->returned, atomic_load(&handover->given));",
        "atomic_store_explicit(&handover->returned, atomic_load(&handover->given), memory_order_relaxed);",
    ),
    "the giver does not ask": (
        "return atomic_load(&handover->returned) == atomic_load(&handover->given);",
        "return atomic_load(&handover->returned) <= atomic_load(&handover->given);",
    ),
}


@needs_spin
def test_spin_finds_nothing_wrong_in_any_interleaving(tmp_path: Path) -> None:
    check_search(spin(MODEL, tmp_path), 100)


@needs_spin
@pytest.mark.parametrize("broken", sorted(BROKEN_MODELS))
def test_spin_refuses_a_broken_model(tmp_path: Path, broken: str) -> None:
    assert "assertion violated" in spin(MODEL, tmp_path, broken)


def test_all_broken_models_are_tried() -> None:
    assert set(re.findall(r"#ifdef (BROKEN_\w+)", MODEL.read_text())) == BROKEN_MODELS


def test_two_threads_lose_nothing(tmp_path: Path) -> None:
    program = compile_program(tmp_path / "stress", [STRESS], options=["-O2"])
    done = run_program([program, "2000"])
    assert (done.returncode, done.stdout) == (0, "rounds 2000\n")


def under_thread_sanitizer(folder: Path, header: Path, rounds: str) -> tuple[int, str]:
    """Exit status and report; 66, immediately, if ThreadSanitizer detects an error."""
    include = folder / "include" / "epg"
    include.mkdir(parents=True)
    shutil.copy(header, include / "handover.h")
    source = folder / "stress.c"
    source.write_text(STRESS.read_text().replace('"epg/handover.h"', f'"{include / "handover.h"}"'))
    program = compile_program(folder / "races", [source], options=["-O1", *THREAD_SANITIZER])
    environment = {"TSAN_OPTIONS": "halt_on_error=1 exitcode=66"}
    done = run_program([program, rounds], environment=environment)
    if "unexpected memory mapping" in done.stderr:
        # This ThreadSanitizer does not support the address-space randomisation of newer kernels.
        done = run_program(["setarch", platform.machine(), "-R", program, rounds], environment=environment)
    return done.returncode, done.stdout + done.stderr


def test_thread_sanitizer_finds_no_race(tmp_path: Path) -> None:
    status, report = under_thread_sanitizer(tmp_path, HANDOVER, "1000")
    assert status == 0, report


@pytest.mark.parametrize("mutation", sorted(MUTATIONS))
def test_a_broken_handover_is_seen(tmp_path: Path, mutation: str) -> None:
    old, new = MUTATIONS[mutation]
    text = HANDOVER.read_text()
    assert text.count(old) == 1, old
    broken = tmp_path / "handover.h"
    broken.write_text(text.replace(old, new))
    status, report = under_thread_sanitizer(tmp_path, broken, PATIENCE)
    assert status in (1, 66), report
