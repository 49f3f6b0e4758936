# SPDX-License-Identifier: Apache-2.0
"""Puts the modules of this folder (``writer``, ``closed_loop``) on the module path."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
