# SPDX-License-Identifier: Apache-2.0
"""The command that installs EPG, for messages and generated projects.

CMake's files, the README and ``docs/installing.md`` repeat it; ``tests/docs/test_installing.py`` compares them.
"""

from __future__ import annotations

ACTIVATE = ". ~/epg-environment/bin/activate"
"""The command that makes the program ``epg`` available in a terminal."""

_MAKE = "python3 -m venv ~/epg-environment"


def install_command(folder: str = "<folder of EPG>") -> str:
    """The command that installs EPG from ``folder``, a checkout, into a virtual environment.

    EPG is not on PyPI.  Debian and Ubuntu refuse ``pip install`` outside of a virtual environment (PEP 668).
    """
    return f"{_MAKE} && {ACTIVATE} && pip install {folder}"
