# SPDX-License-Identifier: Apache-2.0
"""Mutants of small sources, their identities, and the results that count as worse than before."""

from __future__ import annotations

import ast
import inspect
from pathlib import Path

import pytest

from tests.mutants import c_source, python_source, results, workshop
from tests.mutants.__main__ import main
from tests.mutants.choice import Choice, find
from tests.mutants.mutant import Identity, Mutant
from tests.mutants.results import CAUGHT, EQUIVALENT, Result
from tests.mutants.server import replace_functions
from tests.mutants.trial import CLOSED_LOOP, IN_PROCESS

PYTHON = '''
class Pins:
    def free(self, pin: int) -> bool:
        """Whether a pin is free."""
        # nobody uses it
        if 0 <= pin < self.count and not self.used:
            self.log("a pin is free", pin)
            return True
        raise KeyError(pin)
'''
C = """
static const int table[] = {1, 2};

static int sum(const int *values, int count)
{
    int result = 0; /* nothing yet */
    for (int i = 0; i < count; i++) {
        result += values[i];
    }
    if (result) {
        show(result);
    }
    return -result;
}
"""


def changes(mutants: list[Mutant]) -> list[tuple[str, str]]:
    return [(mutant.identity.before, mutant.identity.after) for mutant in mutants]


def in_python(text: str) -> list[Mutant]:
    return list(python_source.mutants(text, "pins.py"))


def in_c(text: str) -> list[Mutant]:
    return list(c_source.mutants(text, "sum.c"))


def test_mutants_of_python() -> None:
    found = in_python(PYTHON)
    head = "if 0 <= pin < self.count and (not self.used):"
    assert changes(found) == [
        (head, "if 0 <= pin < self.count or not self.used:"),
        (head, "if 0 < pin < self.count and (not self.used):"),
        (head, "if 0 <= pin <= self.count and (not self.used):"),
        (head, "if 1 <= pin < self.count and (not self.used):"),
        (head, "if -1 <= pin < self.count and (not self.used):"),
        (head, "if 0 <= pin < self.count and self.used:"),
        ("self.log('…', pin)", "pass"),
        ("return True", "return False"),
        ("raise KeyError(pin)", "pass"),
    ]
    assert {mutant.identity.function for mutant in found} == {"Pins.free"}
    assert "self.log('a pin is free', pin)" in found[0].text()
    texts = [mutant.text() for mutant in found]
    assert len({*texts, ast.unparse(ast.parse(PYTHON)) + "\n"}) == len(found) + 1
    for text in texts:
        compile(text, "pins.py", "exec")


def test_a_part_of_a_long_statement_is_its_identity() -> None:
    other = ", ".join(f"name_{k}=value_{k}" for k in range(20))
    assert changes(in_python(f"x = Row({other}, first=a < b)\n")) == [("first=a < b", "first=a <= b")]


def test_mutants_of_c() -> None:
    found = in_c(C)
    assert changes(found) == [
        ("int result = 0", "int result = 1"),
        ("for ( int i = 0 ; i < count ; i ++ )", "for ( int i = 1 ; i < count ; i ++ )"),
        ("for ( int i = 0 ; i < count ; i ++ )", "for ( int i = 0 ; i <= count ; i ++ )"),
        ("result += values [ i ]", "(removed)"),
        ("result += values [ i ]", "result -= values [ i ]"),
        ("if ( result )", "if ( 0 == result )"),
        ("show ( result )", "(removed)"),
    ]
    assert {mutant.identity.function for mutant in found} == {"sum"}
    assert "int result =  1 ;" in found[0].text()
    assert found[0].lines == range(6, 7)


def test_comments_messages_and_lines_are_not_part_of_an_identity() -> None:
    other = PYTHON.replace("# nobody uses it", "# Nothing\n        # uses it.").replace("a pin is free", "free, is it")
    assert [m.identity for m in in_python(other)] == [m.identity for m in in_python(PYTHON)]
    other = C.replace("/* nothing yet */", "// Still\n\n").replace("    ", "  ")
    assert [m.identity for m in in_c(other)] == [m.identity for m in in_c(C)]


def test_a_statement_that_moved_is_found() -> None:
    moved = [Choice("resolve", mutant) for mutant in in_python(PYTHON.replace("Pins", "Free").replace("0 <=", "2 <="))]
    before = {mutant.identity.after: mutant.identity for mutant in in_python(PYTHON)}
    assert find(moved, Identity("Free.free", "return True", "return False"))
    assert not find(moved, before["return False"]), "too short to be looked for in other functions"
    assert not find(moved, before["if 1 <= pin < self.count and (not self.used):"]), "it was rewritten"
    long = Identity(
        "Pins.free", "if 2 <= pin < self.count and (not self.used):", "if 2 <= pin < self.count and self.used:"
    )
    assert [one.mutant.identity.function for one in find(moved, long)] == ["Free.free"]
    assert not find(moved * 2, long), "two places: none is surely the one"


def test_results_are_read_as_they_were_written(tmp_path: Path) -> None:
    found = [
        Result(CAUGHT, "emit", Identity("f", "a | b", "a & b")),
        Result(EQUIVALENT, "runtime", Identity("g", "x", "(removed)"), "it is set anew in each cycle"),
    ]
    results.write(tmp_path / "results.txt", found)
    assert results.read(tmp_path / "results.txt") == found
    (tmp_path / "results.txt").write_text("caught\temit\tf\ta\n")
    with pytest.raises(ValueError, match=r"results\.txt:1: this is not a result"):
        results.read(tmp_path / "results.txt")


def is_small(number: int) -> bool:
    return number < 10


def test_functions_are_replaced_where_they_are() -> None:
    """Functions are also replaced where other modules have imported them, as here under the name ``imported``."""
    imported = is_small
    source = inspect.getsource(inspect.getmodule(is_small) or is_small)
    mutant = next(m for m in python_source.mutants(source, "x") if m.identity.after == "return number <= 10")
    changed = mutant.changed()
    original = compile(source, __file__, "exec")
    assert not isinstance(changed, str)
    replace_functions(compile(changed, __file__, "exec"))
    try:
        assert imported(10)
    finally:
        replace_functions(original)
    assert not imported(10)


def test_the_tests_that_run_a_line_come_in_order() -> None:
    mutant = in_python(PYTHON)[0]
    coverage = {
        "slow": (9.0, {"pins.py": [5, 6]}),
        "quick": (0.1, {"pins.py": [6]}),
        "tests/test_pins.py::own": (5.0, {"pins.py": [6]}),
        "elsewhere": (0.1, {"pins.py": [7], "a.py": [6]}),
        "too slow": (10.0, {"pins.py": [6]}),
    }
    own = "tests/test_pins.py::own"
    assert workshop.tests_of(mutant, coverage, 15.0) == [own, "quick", "slow"]
    assert workshop.tests_of(mutant, coverage, workshop.ALL) == [own, "quick", "slow", "too slow"]
    assert workshop.tests_of(mutant, coverage, 0.0) == [own]


def test_the_tests_that_are_chosen_exist() -> None:
    assert [name for name in [*IN_PROCESS, *CLOSED_LOOP] if not (workshop.ROOT / name).exists()] == []


def test_mutants_that_were_caught_are_still_caught() -> None:
    assert main(["--check"]) == 0
