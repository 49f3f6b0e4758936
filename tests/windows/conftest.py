# SPDX-License-Identifier: Apache-2.0
"""A Windows computer for the tests of a file."""

from __future__ import annotations

import shutil
from collections.abc import Iterator

import pytest

from tests.windows.computer import Computer


@pytest.fixture(scope="module")
def computer(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Computer]:
    made = Computer(tmp_path_factory.mktemp("windows"))
    made.boot()
    yield made
    made.end()
    shutil.rmtree(made.prefix, ignore_errors=True)
