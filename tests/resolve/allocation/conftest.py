# SPDX-License-Identifier: Apache-2.0
"""Helpers of this folder on the module path."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
