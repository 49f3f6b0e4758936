# SPDX-License-Identifier: Apache-2.0
"""EPG's CMake package has no knowledge of families of chips: each brings its functions in a file sdk.cmake."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from tests.cmake.project import CMAKE_DIR, ROOT

OWN = """
macro(epg_import_motor_sdk)
  set(MOTOR_SDK_PATH "${CMAKE_SOURCE_DIR}/sdk")
endmacro()
"""
PROJECT = """
cmake_minimum_required(VERSION 3.22...3.31)
include(%s/epg_import.cmake)
epg_import_motor_sdk()
project(x LANGUAGES NONE)
message(STATUS "found: ${MOTOR_SDK_PATH}")
if(COMMAND epg_import_pico_sdk AND TARGET EPG::pico_quadrature)
  message(STATUS "EPG's own families are there")
endif()
"""


def test_a_family_of_the_user_brings_a_function_before_project(tmp_path: Path) -> None:
    family = tmp_path / "my targets/families/motor"
    family.mkdir(parents=True)
    (family / "sdk.cmake").write_text(OWN)
    (tmp_path / "CMakeLists.txt").write_text(PROJECT % CMAKE_DIR)
    command = ["cmake", "-S", str(tmp_path), "-B", str(tmp_path / "build"), f"-DEPG_PATH={ROOT}"]
    by_variable = [*command, "-DEPG_TARGETS_PATH=my targets"]
    for words, environment in ((command, {"EPG_TARGETS_PATH": str(tmp_path / "my targets")}), (by_variable, {})):
        done = subprocess.run(words, capture_output=True, text=True, env={**os.environ, **environment})
        assert f"found: {tmp_path}/sdk\n" in done.stdout, done.stderr
        assert "EPG's own families are there" in done.stdout


def test_the_package_names_no_family() -> None:
    families = "|".join(path.parent.name for path in (ROOT / "targets/families").glob("*/family.yaml"))
    named = re.compile(rf"{families}|pico", re.IGNORECASE)
    assert families
    assert [path.name for path in CMAKE_DIR.glob("*.cmake") if named.search(path.read_text(encoding="utf-8"))] == []
