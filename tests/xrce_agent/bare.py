# SPDX-License-Identifier: Apache-2.0
"""Builds ``programs/bare_client.c`` once per version of its sources and of the client library."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
from pathlib import Path

from epg.bootstrap import cache_folder
from tests.emulator.toolchain import Missing, locked, tool

PROGRAMS = Path(__file__).resolve().parent / "programs"


def libraries() -> tuple[Path, Path]:
    """The folders of eProsima's client and of Micro-CDR."""
    return tool("micro_xrce_dds_client"), tool("micro_cdr")


def bare_client() -> Path:
    """The executable; raises :class:`Missing`."""
    client, cdr = libraries()
    for program, package in (("cmake", "cmake"), ("ninja", "ninja-build")):
        if not shutil.which(program):
            raise Missing(f"{program} is not installed: apt install {package}")
    digest = hashlib.sha256(f"{client} {cdr}".encode())
    for source in sorted(PROGRAMS.iterdir()):
        digest.update(source.read_bytes())
    folder = cache_folder() / "test-build" / f"bare-client-{digest.hexdigest()[:16]}"
    with locked(folder):
        if not (folder / "bare_client").is_file():
            configure = ["cmake", "-S", str(PROGRAMS), "-B", str(folder), "-G", "Ninja"]
            configure += [f"-DCLIENT={client}", f"-DCDR={cdr}"]
            for command in (configure, ["cmake", "--build", str(folder)]):
                done = subprocess.run(command, capture_output=True, text=True, check=False)
                assert done.returncode == 0, done.stdout + done.stderr
    return folder / "bare_client"
