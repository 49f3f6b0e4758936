# SPDX-License-Identifier: Apache-2.0
"""Builds ``programs/bare_client.c`` once per version of its sources and of the client library."""

from __future__ import annotations

import hashlib
import subprocess
from pathlib import Path

from epg.generator.bootstrap import cache_folder
from tests.doubles.toolchain import cmake_and_ninja, locked, tool

PROGRAMS = Path(__file__).resolve().parent / "programs"


def libraries() -> tuple[Path, Path]:
    """The folders of eProsima's client and of Micro-CDR."""
    return tool("micro_xrce_dds_client"), tool("micro_cdr")


def bare_client() -> Path:
    """The executable; raises :class:`Missing`."""
    client, cdr = libraries()
    cmake_and_ninja()
    digest = hashlib.sha256(f"{client} {cdr}".encode())
    for source in sorted(PROGRAMS.iterdir()):
        digest.update(source.read_bytes())
    folder = cache_folder() / "test-build" / f"bare-client-{digest.hexdigest()[:16]}"
    with locked(folder):
        if not (folder / "bare_client").is_file():
            options = ("-G", "Ninja", f"-DCLIENT={client}", f"-DCDR={cdr}")
            for command in (["-S", PROGRAMS, "-B", folder, *options], ["--build", folder]):
                subprocess.run(["cmake", *command], check=True, stdout=subprocess.DEVNULL)
    return folder / "bare_client"
