# SPDX-License-Identifier: Apache-2.0
"""Builds the simulation of a system in a CMake project of its own, for ``epg simulate``."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from pathlib import Path

from epg.cli.arguments import user_roots
from epg.cli.main import MissingProgram
from epg.cli.system import read_system
from epg.connect.build.build_messages import Messages, plain
from epg.connect.build.process import Process
from epg.generator.bootstrap import cache_folder
from epg.generator.data import data_folder, targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.source import Span
from epg.generator.tools.find_tool import Surroundings, find_tool
from epg.generator.tools.remedy import get_it, problem_of
from epg.generator.tools.tools import load_tools

PROJECT, BUILD = "simulation", "simulation/build"
"""The project and its build folder, in the folder of the results."""

_LISTS = """# EPG writes this file for `epg simulate`.
cmake_minimum_required(VERSION 3.22)
project({name} LANGUAGES C CXX)
find_package(EPG REQUIRED)
epg_add_system({name} SYSTEM "{system}")
"""


def build_simulation(
    path: Path, output: Path, diagnostics: Diagnostics, progress: Callable[[str], None] = lambda message: None
) -> Path:
    """The program that simulates the system in ``path``, built in the folder ``output``.

    A later run builds only what has changed.  Stops after reporting mistakes in the files of the system, or of the
    build.  Raises MissingProgram if a program for the build is missing.
    """
    checked = read_system(path, user_roots(), diagnostics)
    diagnostics.stop_if_errors()
    assert checked is not None
    programs = _programs()
    name = f"{checked.system.name}_simulation"
    project, build = output.resolve() / PROJECT, output.resolve() / BUILD
    project.mkdir(parents=True, exist_ok=True)
    text = _LISTS.format(name=name, system=path.resolve().as_posix().replace('"', '\\"'))
    lists = project / "CMakeLists.txt"
    if not lists.is_file() or lists.read_text(encoding="utf-8") != text:
        lists.write_text(text, encoding="utf-8", newline="\n")
    configure = [programs["cmake"], "-S", str(project), "-B", str(build), "-DCMAKE_BUILD_TYPE=Release"]
    configure += [f"-DEPG_DIR={data_folder('cmake').as_posix()}", f"-DPython3_EXECUTABLE={sys.executable}"]
    if "ninja" in Path(programs["build_program"]).name and not (build / "CMakeCache.txt").is_file():
        configure += ["-G", "Ninja", f"-DCMAKE_MAKE_PROGRAM={programs['build_program']}"]
    messages = Messages((path.resolve().parent, build))

    def read(line: str) -> None:
        text = plain(line)
        messages.read(text)
        progress(text[:100])

    compile_all = [programs["cmake"], "--build", str(build), "--parallel", str(os.cpu_count() or 1)]
    for command in (configure, compile_all):
        if Process(command, project, os.environ | {"LC_MESSAGES": "C"}, read).run() != 0:
            for message in messages.finish(failed=True):
                span = Span(message.file or str(path), message.line, message.column, message.column + 1)
                diagnostics.error(message.id or "simulation-failed", span, message.message, hint=message.hint)
            diagnostics.stop_if_errors()
    of_windows = build / f"{name}.exe"
    return of_windows if of_windows.is_file() else build / name


def _programs() -> dict[str, str]:
    """The paths of the programs that the build needs."""
    tools = load_tools(targets_roots(user_roots()), Diagnostics())
    where = Surroundings.here(cache_folder())
    found = {name: find_tool(tools[name], where) for name in ("cmake", "build_program", "c_compiler", "cxx_compiler")}
    for finding in found.values():
        if finding.status != "found":
            raise MissingProgram(f"{problem_of(finding)}. {get_it(finding.tool, where, tools)}")
    return {name: str(finding.path) for name, finding in found.items()}
