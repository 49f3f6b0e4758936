# SPDX-License-Identifier: Apache-2.0
"""A plugin of pytest that collects tests once, and then runs some of them at every request.

Each run is in a fork, after the functions of one module have been replaced by those of a mutant.  Requests and
answers are lines of JSON in the pipes whose numbers are in ``EPG_MUTANTS_PIPES``.
"""

from __future__ import annotations

import gc
import importlib
import json
import marshal
import os
import signal
import sys
import time
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import pytest

FOLDER = str(Path(__file__).resolve().parents[2]) + os.sep
MEMORY = 3 << 30
"""Limit of a fork's memory in bytes: a mutant may fill the memory."""
CALLS = 20
"""Number of calls of a function that are traced in each test: more take much time and rarely run other lines."""
Lines = set[tuple[str, int]]


@pytest.hookimpl(tryfirst=True)
def pytest_runtestloop(session: pytest.Session) -> bool | None:
    pipes = os.environ.get("EPG_MUTANTS_PIPES")
    if not pipes:
        return None
    requests, answers = (int(number) for number in pipes.split())
    with os.fdopen(requests) as lines, os.fdopen(answers, "w") as answer:
        for line in lines:
            answer.write(f"{json.dumps(_fork(session, json.loads(line)))}\n")
            answer.flush()
    return True


def _fork(session: pytest.Session, request: dict[str, Any]) -> bool:
    """Runs tests in a fork; True if they passed."""
    child = os.fork()
    if child == 0:
        os.setsid()
        status = 1
        try:
            status = _run(session, request)
        finally:
            os._exit(status)
    end = time.monotonic() + request["limit"]
    while True:
        ended, status = os.waitpid(child, os.WNOHANG)
        if ended:
            return status == 0
        if time.monotonic() > end or _memory(child) > MEMORY:
            os.killpg(child, signal.SIGKILL)
            os.waitpid(child, 0)
            return False
        time.sleep(0.01)


def _memory(process: int) -> int:
    try:
        return int(Path(f"/proc/{process}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")
    except OSError:
        return 0


def _run(session: pytest.Session, request: dict[str, Any]) -> int:
    if "code" in request:
        importlib.import_module(request["module"])  # the command line imports it when a test calls it, with other code
        replace_functions(marshal.loads(Path(request["code"]).read_bytes()))
    if "record" in request:
        files = sorted({item.path for item in session.items})[request["part"] :: request["parts"]]
        return _record(session, [item for item in session.items if item.path in files], Path(request["record"]))
    tests = {item.nodeid: item for item in session.items}
    items = [tests[name] for name in request["tests"]]
    for item, following in zip(items, [*items[1:], None]):
        session.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        if session.testsfailed:
            return 1
    return 0


def replace_functions(module: CodeType) -> None:
    """Gives each function of a module its code in ``module``, found by the same name and the same line."""
    codes: dict[tuple[str, int], CodeType] = {}
    found = [module]
    while found:
        inner = [one for one in found.pop().co_consts if isinstance(one, CodeType)]
        codes |= {(one.co_name, one.co_firstlineno): one for one in inner if not one.co_name.startswith("<")}
        found += inner
    for function in gc.get_objects():
        if isinstance(function, FunctionType) and function.__code__.co_filename == module.co_filename:
            code = function.__code__
            new = codes.get((code.co_name, code.co_firstlineno))
            if new is not None and len(new.co_freevars) == len(code.co_freevars):
                function.__code__ = new


def _record(session: pytest.Session, items: Sequence[pytest.Item], path: Path) -> int:
    """Writes ``{test: [seconds, {file: [line, ...]}]}`` of the tests that pass.

    The lines that fixtures run during the first test of a file count for all tests of the file.
    """
    record: dict[str, tuple[float, Lines]] = {}
    fixtures: dict[str, Lines] = defaultdict(set)
    for item, following in zip(items, [*items[1:], None]):
        lines: Lines = set()
        began, failed = _used(), session.testsfailed
        in_fixtures = fixtures[item.nodeid.partition("::")[0]]
        plugin = _Tracer(lines, in_fixtures)
        session.config.pluginmanager.register(plugin)
        session.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
        session.config.pluginmanager.unregister(plugin)
        if session.testsfailed == failed and plugin.called:
            record[item.nodeid] = (_used() - began, lines)
    result = {}
    for test, (seconds, lines) in record.items():
        files: dict[str, list[int]] = defaultdict(list)
        for file, number in sorted(lines | fixtures[test.partition("::")[0]]):
            files[Path(file.removeprefix(FOLDER)).as_posix()].append(number)
        result[test] = [seconds, files]
    path.write_text(json.dumps(result), encoding="utf-8")
    return 0


def _used() -> float:
    """Processor seconds of this process and of the programs it has started, so that other programs do not count."""
    return sum(os.times()[:4])


class _Tracer:
    """Collects the lines of EPG that a test and its fixtures run."""

    def __init__(self, lines: Lines, in_fixtures: Lines) -> None:
        self.called = False
        self._lines = lines
        self._in_fixtures = in_fixtures

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_setup(self) -> Any:
        sys.settrace(_tracer(self._in_fixtures))
        yield
        sys.settrace(None)

    @pytest.hookimpl(hookwrapper=True)
    def pytest_runtest_call(self) -> Any:
        self.called = True
        sys.settrace(_tracer(self._lines))
        yield
        sys.settrace(None)


def _tracer(lines: Lines) -> Any:
    calls: dict[CodeType, int] = defaultdict(int)

    def line(frame: FrameType, event: str, argument: object) -> Any:
        lines.add((frame.f_code.co_filename, frame.f_lineno))
        return line

    def call(frame: FrameType, event: str, argument: object) -> Any:
        code = frame.f_code
        calls[code] += 1
        wanted = calls[code] <= CALLS and code.co_filename.startswith(f"{FOLDER}epg{os.sep}")
        return line(frame, event, argument) if wanted else None

    return call
