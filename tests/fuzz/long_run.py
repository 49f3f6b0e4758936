# SPDX-License-Identifier: Apache-2.0
"""The number of examples.  HYPOTHESIS_PROFILE=longer tries four times as many, the same ones in each run;
HYPOTHESIS_PROFILE=long tries twenty times as many, and different ones in each run.
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
"""Settings of every property test in this folder: each normal run uses the same examples."""


def examples(normal: int) -> int:
    """The number of examples of a property test that has ``normal`` examples in a normal run."""
    return normal * {"long": 20, "longer": 4}.get(os.environ.get("HYPOTHESIS_PROFILE", ""), 1)
