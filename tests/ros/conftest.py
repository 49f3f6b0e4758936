# SPDX-License-Identifier: Apache-2.0
"""Fixtures for the tests of the ROS tools: CycloneDDS for Python, and a separate network."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from epg import bootstrap

bootstrap.ensure("ros")

from tests.ros2.network import Network, network  # noqa: E402  # only after the check that cyclonedds can be imported


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found
