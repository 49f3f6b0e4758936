# SPDX-License-Identifier: Apache-2.0
"""``docs/console.md`` is true, and so are the commands of ``docs/bring-up.md``.

Their sessions work with a real executable, and ``console.md`` names every command and value.

In a ``session`` block, ``> command`` is input; the lines below are the expected output, in that order.  ``...`` in a
line matches any text, and a line ``...`` matches any lines.
"""

from __future__ import annotations

import re
import time
from functools import partial
from pathlib import Path

import pytest

from tests.waiting import until

from .client import Host

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "console.md").read_text(encoding="utf-8")
CONSOLE = ROOT / "targets" / "middlewares" / "console"
BRING_UP = (ROOT / "docs" / "bring-up.md").read_text(encoding="utf-8")
SESSIONS = re.findall(r"^```session\n(.*?)^```$", PAGE + BRING_UP, re.MULTILINE | re.DOTALL)


def pattern(line: str) -> str:
    return ".*".join(re.escape(part) for part in line.split("..."))


def comes(console: Host, line: str, among_others: bool) -> bool:
    """True if the next line is this one."""
    got = console.until("")[0]
    found = re.fullmatch(pattern(line), got) is not None
    assert found or among_others or got.startswith(("watch ", "state ", "csv ")), f"{line} is expected, not {got}"
    return found


def hold(console: Host, session: str) -> None:
    """Sends the input of a session and finds its output; notices about other events may appear in between."""
    for exchange in re.split(r"^> ", session, flags=re.MULTILINE)[1:]:
        command, *lines = exchange.splitlines()
        time.sleep(0.5)  # as a user does, and until the axes have stopped
        console.send(command + "\n")
        for line in lines:
            if line != "...":
                until(partial(comes, console, line, "..." in lines), f"> {command}\n{line} does not come", pause=0.0)


@pytest.mark.parametrize("number", range(len(SESSIONS)))
def test_sessions(jiwy_host: Path, number: int) -> None:
    with Host(jiwy_host) as console:
        console.ask("version")  # after the answer, the loop runs
        hold(console, SESSIONS[number])


def test_the_commands_of_the_ten_steps_exist(jiwy_host: Path) -> None:
    """Each command that a step says to type, in their order, at the simulated robot."""
    first = r"version|stats|watch|jog|enable|disable"
    typed = re.findall(rf"`((?:{first})\b[^`=:]*)`", BRING_UP[BRING_UP.index("1. **") : BRING_UP.index("Practise")])
    assert {command.split()[0] for command in typed} == set(first.split("|"))
    assert len(re.findall(r"^\d+\. \*\*", BRING_UP, re.MULTILINE)) == 10
    with Host(jiwy_host) as console:
        for command in typed:
            assert command == "jog" or console.ask(command)[-1].startswith("ok "), command


def test_a_wrong_session_is_noticed(jiwy_host: Path) -> None:
    with Host(jiwy_host) as console, pytest.raises(AssertionError):
        hold(console, "> jog pwm_pan 0.5 1\nerror jog something else\n")


def test_all_commands_are_there() -> None:
    handlers = re.findall(r'\{"(\w+)", epg_console_\w+\}', (CONSOLE / "console.c").read_text())
    assert len(handlers) > 10
    table = PAGE[PAGE.index("| command |") : PAGE.index("A `<setpoint>`")]
    helped = (CONSOLE / "lists.c").read_text()
    helped = helped[helped.index("help[]") :].partition("};")[0]
    for name in handlers:
        assert re.search(rf"`{name}\b", table), name
        assert re.search(rf"\b{name}\b", helped) or name == "help", name


def test_all_first_words_are_there() -> None:
    grammar = PAGE[PAGE.index("line      =") : PAGE.index("value     =")]
    words = set()
    for source in CONSOLE.glob("*.c"):
        words |= {
            word.split()[0] for word in re.findall(r'(?:epg_console_begin|tell)\([^"]*"(\w[^"]*)"', source.read_text())
        }
    assert words == set(re.findall(r'"(\w+)"', grammar))
