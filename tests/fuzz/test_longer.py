# SPDX-License-Identifier: Apache-2.0
"""The property tests with four times as many examples."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent


def test_more_examples() -> None:
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(FOLDER)]
    environment = {**os.environ, "HYPOTHESIS_PROFILE": "longer"}
    done = subprocess.run(
        command, cwd=FOLDER.parent.parent, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    )
    assert done.returncode == 0, done.stdout
