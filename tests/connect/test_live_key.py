# SPDX-License-Identifier: Apache-2.0
"""A console by UDP with a key, in the page: it is asked for once."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.connect.page import Denied, Page, serving, session_of
from tests.live.udp_target import UdpTarget

ROOT = Path(__file__).resolve().parents[2]
KEY = "0011-2233-4455-6677-8899-aabb-ccdd-eeff"


@pytest.fixture
def target(jiwy_host: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[UdpTarget]:
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path / "config"))
    file = tmp_path / "console.key"
    file.write_text(KEY)
    file.chmod(0o600)
    found = UdpTarget(jiwy_host, tmp_path, options=("--console-key", str(file)))
    yield found
    found.process.kill()
    found.process.communicate()


def test_the_page_asks_for_the_key_once(target: UdpTarget) -> None:
    path = str(target.port)

    def locked(page: Page) -> str:
        found: str = page.state()["live"]["locked"]
        return found

    with serving(session_of(ROOT / "examples/jiwy")) as page:
        assert locked(page) == ""
        with pytest.raises(Denied, match=f"{path} needs a key"):
            page.post("live/connect", path=path)
        assert locked(page) == path
        with pytest.raises(Denied, match="this is not the key of a console"):
            page.post("live/connect", path=path, key="12345")
        with pytest.raises(Denied, match=f"{path} has another key"):
            page.post("live/connect", path=path, key="00" * 16)
        assert locked(page) == path
        page.post("live/connect", path=path, key=KEY)
        assert locked(page) == ""
        assert page.state()["live"]["target"]["name"] == "jiwy"
    with serving(session_of(ROOT / "examples/jiwy")) as page:
        page.post("live/connect", path=path)
        assert page.state()["live"]["target"]["name"] == "jiwy"
