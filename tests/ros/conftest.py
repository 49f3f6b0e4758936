# SPDX-License-Identifier: Apache-2.0
"""Fixtures for the tests of the ROS tools: a separate network."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.ros2.network import Network, network


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found
