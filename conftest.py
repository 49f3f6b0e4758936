# SPDX-License-Identifier: Apache-2.0
"""The hooks of pytest for all tests: those in ``tests``, and those of the folders in ``integration``."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from tests.hooks import *  # noqa: F403
