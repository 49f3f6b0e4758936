# SPDX-License-Identifier: Apache-2.0
"""The licence: its text, and the line at the beginning of sources and generated files."""

from __future__ import annotations

import hashlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from epg.generator.emit.licence import first_line
from tests.checkout import ROOT, listed
from tests.docs.licence_lines import LINE, sources, with_line


def test_the_licence_is_the_whole_text() -> None:
    """The text is that of https://www.apache.org/licenses/LICENSE-2.0.txt."""
    text = (ROOT / "LICENSE").read_bytes()
    assert hashlib.sha256(text).hexdigest() == "cfc7749b96f63bd31c3c42b5c471bf756814053e847c10f3eb003417bc523d30"


@pytest.mark.parametrize("tcf", ["host_jiwy.tcf", "rpi_pico_freertos_jiwy.tcf", "rpi_pico_zephyr_jiwy.tcf"])
def test_generated_files_say_it_in_their_first_line(tcf: str, tmp_path: Path) -> None:
    jiwy = ROOT / "examples/jiwy"
    command = [sys.executable, str(ROOT / "epg"), "generate", "jiwy", "--tcf", tcf, "--model", str(jiwy / "model")]
    command += ["--bindings", str(jiwy / "jiwy.bindings.yaml"), "--output", str(tmp_path)]
    subprocess.run(command, check=True, capture_output=True)
    files = [path for path in tmp_path.rglob("*") if path.is_file() and path.suffix != ".json"]
    assert len(files) > 8
    assert [path.name for path in files if LINE not in path.read_text(encoding="utf-8").split("\n")[0]] == []


def test_what_is_not_epgs_text_has_no_line_or_another_one() -> None:
    assert first_line("jiwy_copies/xxmodel.c") == first_line("jiwy_fmu/model.c") == first_line("jiwy.json") == ""
    assert first_line("jiwy_headers/fmi2Functions.h") == "/* SPDX-License-Identifier: BSD-2-Clause */"
    assert first_line("jiwy_headers/XXTypes.h") == f"/* {LINE} */"
    assert "Modelica Association" in (ROOT / "NOTICE").read_text(encoding="utf-8")


def test_sources_say_it_at_their_beginning() -> None:
    """``EPG_UPDATE_GOLDEN=1`` adds the missing lines."""
    names = sources(listed("--cached", "--others", "--exclude-standard"))
    assert len(names) > 500
    missing = []
    for name in names:
        text = (ROOT / name).read_text(encoding="utf-8")
        wanted = with_line(name, text)
        if wanted != text and os.environ.get("EPG_UPDATE_GOLDEN"):
            (ROOT / name).write_text(wanted, encoding="utf-8")
        elif wanted != text:
            missing.append(name)
    assert missing == []


def test_the_line_stands_where_the_language_allows_it() -> None:
    assert with_line("a.py", "#!/usr/bin/env python3\nx\n") == f"#!/usr/bin/env python3\n# {LINE}\nx\n"
    assert with_line("a.c", f"/*\n * {LINE}\n */\n") == f"/*\n * {LINE}\n */\n"
    assert with_line("a.html", "<!doctype html>\n<html>") == f"<!doctype html>\n<!-- {LINE} -->\n<html>"
    assert with_line("a/Kconfig.epg", "x\n") == f"# {LINE}\nx\n"
    assert with_line("__init__.py", "") == ""
