# SPDX-License-Identifier: Apache-2.0
"""Only files that are there for it ask which system they are on, or are compiled for."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("epg", "targets", "cmake")
QUESTIONS = {
    ".py": r"\bsys\.platform\b|\bos\.name\b|\bplatform\.system\(|\bhasattr\((os|signal|socket|subprocess),",
    ".c": r"^ *# *(if|elif).*\b(_WIN32|_WIN64|__linux__|__APPLE__|__unix__|_MSC_VER)\b",
    ".cmake": r"\b(WIN32|APPLE|CMAKE_HOST_\w+)\b|CMAKE_SYSTEM_NAME STREQUAL \"(Linux|Windows|Darwin)\"",
}
QUESTIONS |= {".h": QUESTIONS[".c"], ".j2": QUESTIONS[".c"]}
PLATFORMS = tuple(f"targets/platforms/{name}/platform.cmake" for name in ("host", "simulated"))
ROOMS = ("epg/generator/system", "epg/live/ports", "epg/live/keyboards", *PLATFORMS)
ALONE = {
    "epg/generator/bootstrap.py": "the name of a folder for packages of one system",
    "cmake/EPGPython.cmake": "the separator of a list in the environment, and remedies of messages",
    "cmake/EPGCompiler.cmake": "CMake's generators that are on Windows only, and a remedy of a message",
    "cmake/epg_import.cmake": "a remedy of a message; users copy the file, so it needs nothing else",
    "cmake/EPGModel.cmake": "only ELF objects can be read for the model's variables",
    "epg/generator/emit/model/templates/reset.j2": "that, in the generated C",
    "targets/middlewares/dds/domain.c": "a process number, which is not in C",
}
"""Files with few such questions, for which a room would be larger than the question."""


def test_no_other_file_asks_for_the_system() -> None:
    asking = set()
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*"):
            question = QUESTIONS.get(path.suffix)
            if question and re.search(question, path.read_text(encoding="utf-8"), re.MULTILINE):
                asking.add(path.relative_to(ROOT).as_posix())
    rooms = {file: next((room for room in ROOMS if f"{file}/".startswith(f"{room}/")), "") for file in asking}
    assert {file for file, room in rooms.items() if not room} == set(ALONE)
    assert set(rooms.values()) == {"", *ROOMS}
