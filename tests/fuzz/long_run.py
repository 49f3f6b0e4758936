"""How much is tried: HYPOTHESIS_PROFILE=long tries twenty times as much, and other things in each run."""

from __future__ import annotations

import os

LONG = os.environ.get("HYPOTHESIS_PROFILE") == "long"


def examples(normal: int) -> int:
    """Examples of a property test that has ``normal`` ones in a normal run."""
    return normal * 20 if LONG else normal
