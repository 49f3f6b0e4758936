# SPDX-License-Identifier: Apache-2.0
"""EPG's CMake package has no knowledge of families of chips: each brings its functions in a file sdk.cmake."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

from tests.cmake.project import CMAKE_DIR, ROOT

OWN = """
macro(epg_import_motor_sdk)
  _epg_find_sdk(_motor_sdk motor_sdk)
  if(_motor_sdk_PROBLEM)
    message(FATAL_ERROR "${_motor_sdk_PROBLEM}")
  endif()
endmacro()
"""
TOOL = {
    "api": 1,
    "tool": "motor_sdk",
    "title": "Motor SDK",
    "needed_for": "motor chips",
    "project_version": "required",
    "holds": "motor.h",
    "variables": ["MOTOR_SDK_PATH"],
    "places": ["~/motor/*"],
    "version": {"file": "motor.h", "patterns": ["(\\d+\\.\\d+)"]},
    "get": {"any": "get the SDK"},
}
PROJECT = """
cmake_minimum_required(VERSION 3.22...3.31)
include("%s/epg_import.cmake")
epg_use_versions(MOTOR_SDK ${wanted})
epg_import_motor_sdk()
project(x LANGUAGES NONE)
message(STATUS "found: ${_motor_sdk} ${_motor_sdk_VERSION}")
if(COMMAND epg_import_pico_sdk AND TARGET EPG::pico_quadrature)
  message(STATUS "EPG's own families are there")
endif()
"""


def test_a_family_of_the_user_brings_a_function_before_project(tmp_path: Path) -> None:
    """The user's folder of targets has the function, and the description of the SDK that it finds."""
    folder, home = tmp_path / "my targets", tmp_path / "home"
    for name in ("families/motor", "tools"):
        (folder / name).mkdir(parents=True)
    (folder / "families/motor/sdk.cmake").write_text(OWN)
    (folder / "tools/motor_sdk.json").write_text(json.dumps(TOOL))
    for version in ("1.2", "1.10"):
        (home / "motor" / version).mkdir(parents=True)
        (home / "motor" / version / "motor.h").write_text(version)
    (tmp_path / "CMakeLists.txt").write_text(PROJECT % CMAKE_DIR)

    def configure(build: str, *options: str, **environment: str) -> subprocess.CompletedProcess[str]:
        command = ["cmake", "-S", str(tmp_path), "-B", str(tmp_path / build), f"-DEPG_PATH={ROOT}", *options]
        command += [f"-DPython3_EXECUTABLE={sys.executable}"]
        variables = {**os.environ, "HOME": str(home), **environment}
        return subprocess.run(command, capture_output=True, text=True, env=variables)

    by_environment = configure("a", EPG_TARGETS_PATH=str(folder))
    assert f"found: {home}/motor/1.10 1.10\n" in by_environment.stdout, by_environment.stderr
    by_variable = configure("b", "-DEPG_TARGETS_PATH=my targets", "-Dwanted=1.2")
    assert f"found: {home}/motor/1.2 1.2\n" in by_variable.stdout, by_variable.stderr
    assert "EPG's own families are there" in by_variable.stdout
    missing = " ".join(configure("c", "-DEPG_TARGETS_PATH=my targets", "-Dwanted=2.0").stderr.split())
    assert f"for version 2.0 of the Motor SDK, but the one in {home}/motor/1.10 is 1.10. Get it: get the SDK" in missing
    assert "Or write 1.10 in place of 2.0 in CMakeLists.txt." in missing


def test_the_package_names_no_family() -> None:
    families = "|".join(path.parent.name for path in (ROOT / "targets/families").glob("*/family.yaml"))
    named = re.compile(rf"{families}|pico", re.IGNORECASE)
    assert families
    assert [path.name for path in CMAKE_DIR.glob("*.cmake") if named.search(path.read_text(encoding="utf-8"))] == []
