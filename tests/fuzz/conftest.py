"""Profiles of the property tests, and an environment without variables of EPG."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, Phase, settings

from tests.fuzz.long_run import LONG

_SLOW = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.function_scoped_fixture]

settings.register_profile(
    "fuzz",
    derandomize=not LONG,
    deadline=None,
    database=None,
    suppress_health_check=_SLOW,
    phases=tuple(Phase) if LONG else (Phase.explicit, Phase.generate),
    print_blob=True,
)


@pytest.fixture(autouse=True)
def _no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("EPG_TARGETS_PATH", raising=False)
    monkeypatch.delenv("EPG_ABSOLUTE_PATHS", raising=False)
