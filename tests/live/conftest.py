# SPDX-License-Identifier: Apache-2.0
"""Fixtures: a running target."""

from tests.live.replays import programs
from tests.live.target import jiwy_host, target

__all__ = ["jiwy_host", "programs", "target"]
