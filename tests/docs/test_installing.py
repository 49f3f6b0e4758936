# SPDX-License-Identifier: Apache-2.0
"""Every page gives the same instructions: EPG is not on PyPI, and Debian requires a virtual environment."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from epg.generator.install import ACTIVATE, REMEDIES, install_command
from tests.checkout import ROOT, listed

TEXTS = ("*.md", "*.cmake", "*.j2", "*.py", "*.json", "*.yaml", "*.txt", "*.cmd", "*.js")


def files() -> list[Path]:
    """All texts of the project except those of its tests."""
    return [ROOT / name for name in listed("--", *TEXTS) if not name.startswith("tests/")]


def test_nobody_is_told_to_install_epg_by_its_name() -> None:
    told = re.compile(r"pip3? install (?:[\w.-]+ )*epg(?![-\w/])")
    page = ROOT / "docs/installing.md"
    wrong = [path for path in files() if path != page and told.search(path.read_text(encoding="utf-8"))]
    assert wrong == []
    assert told.search(page.read_text(encoding="utf-8")), "what people try first is named where they look"


@pytest.mark.parametrize("name", ["docs/installing.md", "cmake/epg_import.cmake"])
def test_the_command_is_the_same(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert install_command() in text and ACTIVATE in text
    assert REMEDIES["epg"]["windows"].format(folder="<folder of EPG>") in text


def test_the_readme_installs_its_own_folder() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"\n{install_command('.')}\n" in text and f"\n{REMEDIES['epg']['windows'].format(folder='.')}\n" in text


@pytest.mark.parametrize("name", ["README.md", "docs/windows.md"])
def test_commands_of_windows_are_for_both_of_its_shells(name: str) -> None:
    """PowerShell 5.1 and cmd: a line for each command, and no environment to activate."""
    text = (ROOT / name).read_text(encoding="utf-8")
    lines = "".join(re.findall(r"^```powershell\n(.*?)^```", text, re.MULTILINE | re.DOTALL)).splitlines()
    assert lines
    assert [line for line in lines if re.search(r"[&|;$%~^`'#]|activate|^epg|^python", line)] == []
