# SPDX-License-Identifier: Apache-2.0
"""The limits of ``limits.yaml``: functions, lines of files and rooms, words of the pages, tests in real time."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.size.measure import LIMITS, ROOT, Function, files, files_alone, functions, real_time, rooms, words


@pytest.fixture(scope="module")
def every() -> list[Function]:
    return list(functions(files()))


def too_complex(found: list[Function]) -> dict[str, int]:
    """The functions above the limit of their language, with their complexity."""
    most = {language: limit["most"] for language, limit in LIMITS["complexity"].items()}
    return {function.key: function.complexity for function in found if function.complexity > most[function.language]}


def test_no_function_is_too_complex(every: list[Function]) -> None:
    """The list of exceptions names the functions above a limit and no others, so that it can only shrink."""
    assert too_complex(every) == LIMITS["exceptions"]


def test_few_functions_are_complex(every: list[Function]) -> None:
    for language, limits in LIMITS["complexity"].items():
        for above, most in limits.get("above", {}).items():
            found = [f.key for f in every if f.language == language and f.complexity > above]
            assert len(found) <= most, f"{language}: {len(found)} functions above {above}: {found}"


def test_a_function_above_the_limit_is_found(tmp_path: Path) -> None:
    (tmp_path / "a.py").write_text("def f(a):\n" + "    if a: return a\n" * 20)
    (tmp_path / "a.c").write_text("int f(int a)\n{\n" + "    if (a > 0 && a < 9) return a;\n" * 8 + "}\n")
    (tmp_path / "a.js").write_text("function f(a) {\n" + "  if (a) return a;\n" * 15 + "}\n")
    found = list(functions(["a.c", "a.js", "a.py"], tmp_path))
    assert too_complex(found) == {"a.c f": 17, "a.js f": 16, "a.py f": 21}
    assert [function.lines for function in found] == [11, 17, 21]


def test_functions_are_short(every: list[Function]) -> None:
    long = [f"{f.key}: {f.lines} lines" for f in every if f.lines > LIMITS["function_lines"][f.language]]
    assert long == []


def test_files_are_short() -> None:
    limits = LIMITS["file_lines"]
    found = {name: (ROOT / name).read_bytes().count(b"\n") for name in files() if Path(name).suffix in limits}
    assert {name: lines for name, lines in found.items() if lines > limits[Path(name).suffix]} == {}


def test_rooms_keep_to_their_budgets() -> None:
    """A budget is no more than a tenth above its room, or 100 lines in a small one: what was deleted is not lent."""
    counted = rooms(files())
    budgets = LIMITS["rooms"]
    assert sorted(counted) == sorted(budgets)
    assert {room: lines for room, lines in counted.items() if lines > budgets[room]} == {}
    assert {room: lines for room, lines in counted.items() if budgets[room] > max(1.1 * lines, lines + 100)} == {}


def test_the_pages_are_short() -> None:
    assert words(files()) <= LIMITS["words"]


@pytest.mark.parametrize("kind", LIMITS["real_time"])
def test_few_tests_run_in_real_time(kind: str) -> None:
    """A limit is at most 5 above its number: what was mended does not come back.  Each place tells its reason."""
    places = list(real_time(files(), kind))
    most = LIMITS["real_time"][kind]["most"]
    assert most - 5 <= len(places) <= most, places
    assert [place for place, reason in places if not reason] == []


def test_few_files_run_alone() -> None:
    assert files_alone() == LIMITS["files_alone"]


def test_a_place_in_real_time_is_found(tmp_path: Path) -> None:
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests/a.py").write_text("begin = time.monotonic()\n# it\ntime.sleep(1)\nuntil(lambda: done)\n")
    (tmp_path / "tests/a.c").write_text("clock_gettime(CLOCK_MONOTONIC, &now); /* it */\nnanosleep(&delay, NULL);\n")
    (tmp_path / "tests/a.mjs").write_text("new Promise((go) => setTimeout(go, 9)); // it\nperformance.now();\n")
    clocks, sleeps = (
        list(real_time(["tests/a.c", "tests/a.mjs", "tests/a.py"], kind, tmp_path)) for kind in LIMITS["real_time"]
    )
    assert clocks == [("tests/a.c:1", "it */"), ("tests/a.mjs:2", ""), ("tests/a.py:1", "")]
    assert sleeps == [("tests/a.c:2", ""), ("tests/a.mjs:1", "it"), ("tests/a.py:3", "it")]
