# SPDX-License-Identifier: Apache-2.0
"""Fixtures: a running target."""

from tests.live.target import jiwy_host, target

__all__ = ["jiwy_host", "target"]
