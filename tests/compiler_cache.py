# SPDX-License-Identifier: Apache-2.0
"""ccache for all builds of the tests, if it is installed.

The tests build many small projects.  Each of them compiles the same sources of EPG and of the SDKs, mostly with the
same options.  ccache keeps every object by the hash of its sources, of its options and of its compiler.  A source with
the same inputs is therefore compiled once.  Its output, warnings and exit status are those of the compiler.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import MutableMapping, Sequence
from pathlib import Path

from epg.generator.bootstrap import cache_folder


def share_objects(environment: MutableMapping[str, str]) -> None:
    """Lets every CMake project that starts with ``environment`` use ccache, with the objects in EPG's cache."""
    if shutil.which("ccache"):
        folder = cache_folder() / "test-build"
        environment.update(CMAKE_C_COMPILER_LAUNCHER="ccache", CMAKE_CXX_COMPILER_LAUNCHER="ccache")
        environment.update(CCACHE_DIR=str(folder / "ccache"), CCACHE_MAXSIZE="3G")
        # The name of a build folder, which is in the paths of generated headers, does not change an object.
        environment.update(CCACHE_BASEDIR=str(folder), CCACHE_NOHASHDIR="1")
        # Generated headers are younger than a second.  ccache compares their contents, too.
        environment.update(CCACHE_SLOPPINESS="include_file_ctime,include_file_mtime")


def run_compiler(command: Sequence[str], folder: Path) -> subprocess.CompletedProcess[str]:
    """Runs a compiler in ``folder``, with ccache where CMake projects use it.

    Names of files in ``folder`` become relative to it, so that another copy of the folder shares the objects.
    """
    launcher = os.environ.get("CMAKE_C_COMPILER_LAUNCHER")
    environment = {**os.environ, "CCACHE_BASEDIR": str(folder)}
    command = [*([launcher] if launcher else []), *(part.replace(f"{folder}/", "") for part in command)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd=folder, env=environment)
