# SPDX-License-Identifier: Apache-2.0
"""Fixture: an environment without variables of EPG."""

from __future__ import annotations

import pytest


@pytest.fixture(autouse=True)
def _no_variables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("EPG_TARGETS_PATH", raising=False)
    monkeypatch.delenv("EPG_ABSOLUTE_PATHS", raising=False)
