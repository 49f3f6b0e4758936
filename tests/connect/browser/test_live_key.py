# SPDX-License-Identifier: Apache-2.0
"""Live: the page asks for the key of a console by UDP, with a field."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from epg.live.udp_keys import file_of
from tests.live.udp_target import UdpTarget

from .axe import violations

KEY = "0011-2233-4455-6677-8899-aabb-ccdd-eeff"


def test_the_key_is_typed_into_a_field(
    jiwy: Any, open_page: Callable[..., Any], jiwy_host: Path, tmp_path: Path
) -> None:
    file = tmp_path / "console.key"
    file.write_text(KEY)
    file.chmod(0o600)
    target = UdpTarget(jiwy_host, tmp_path, options=("--console-key", str(file)))
    kept = file_of(target.port)  # the page's server runs already, so it has the user's own folder
    kept.unlink(missing_ok=True)
    try:
        page = open_page(jiwy.address)
        page.get_by_role("tab", name="Live").click()
        page.get_by_label("Port", exact=True).fill(str(target.port))
        page.get_by_role("button", name="Connect", exact=True).click()
        field = page.get_by_label(f"Key of {target.port}")
        field.wait_for()
        page.get_by_role("button", name="Larger").click()
        assert violations(page) == []
        field.fill("00" * 16)
        page.get_by_role("button", name="Connect with this key").click()
        page.get_by_text("has another key than the one that was given").first.wait_for()
        field.fill(KEY)
        field.press("Enter")
        page.get_by_role("tab", name="Live ● enabled").wait_for()
        assert page.get_by_label(f"Key of {target.port}").count() == 0
        jiwy.epg.post("live/disconnect")
        page.get_by_label("Port", exact=True).fill(str(target.port))
        page.get_by_role("button", name="Connect", exact=True).click()
        page.get_by_role("tab", name="Live ● enabled").wait_for()
        jiwy.epg.post("live/disconnect")
        assert kept.stat().st_mode & 0o777 == 0o600
    finally:
        kept.unlink(missing_ok=True)
        target.process.kill()
        target.process.communicate()
