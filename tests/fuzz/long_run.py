# SPDX-License-Identifier: Apache-2.0
"""How much is tried: HYPOTHESIS_PROFILE=longer tries four times as much, the same in each run; HYPOTHESIS_PROFILE=long
twenty times as much, and other things in each run.
"""

from __future__ import annotations

import os

from hypothesis import HealthCheck, Phase, settings

LONG = os.environ.get("HYPOTHESIS_PROFILE") == "long"

PROFILE = settings(
    derandomize=not LONG,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture],
    phases=tuple(Phase) if LONG else (Phase.explicit, Phase.generate),
    print_blob=True,
)
"""Settings of every property test here: a normal run is the same each time."""


def examples(normal: int) -> int:
    """Examples of a property test that has ``normal`` ones in a normal run."""
    return normal * {"long": 20, "longer": 4}.get(os.environ.get("HYPOTHESIS_PROFILE", ""), 1)
