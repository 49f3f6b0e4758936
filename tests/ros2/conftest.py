# SPDX-License-Identifier: Apache-2.0
"""Fixtures: robots as a user builds them, each test on its own DDS network."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.doubles.toolchain import Missing
from tests.ros2.build import Build, build_robots
from tests.ros2.network import Network, network


def _build(tmp_path_factory: pytest.TempPathFactory, name: str, flags: str) -> Build:
    try:
        return build_robots(tmp_path_factory.mktemp(name), flags)
    except Missing as problem:
        pytest.skip(str(problem))


@pytest.fixture(scope="session")
def build(tmp_path_factory: pytest.TempPathFactory) -> Build:
    return _build(tmp_path_factory, "robots", "-O2")


@pytest.fixture(scope="session")
def build_checked(tmp_path_factory: pytest.TempPathFactory) -> Build:
    """A build with AddressSanitizer and UndefinedBehaviorSanitizer, and all warnings as errors."""
    flags = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=all"
    warnings = "-Wall -Wextra -Wconversion -Wdouble-promotion -Werror"
    return _build(tmp_path_factory, "robots_checked", f"{flags} {warnings}")


@pytest.fixture
def net() -> Iterator[Network]:
    with network() as found:
        yield found
