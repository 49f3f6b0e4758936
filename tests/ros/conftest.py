# SPDX-License-Identifier: Apache-2.0
"""What tests of the ROS tools share: CycloneDDS for Python, and a network of their own."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from epg import bootstrap

bootstrap.ensure("ros")

from tests.ros2.network import Network, network  # noqa: E402  # after cyclonedds can be imported


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found
