# SPDX-License-Identifier: Apache-2.0
"""Puts the helpers of this folder on the module path."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
