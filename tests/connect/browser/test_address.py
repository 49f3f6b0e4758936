# SPDX-License-Identifier: Apache-2.0
"""An address opens one page, and is of no use to others afterwards."""

from __future__ import annotations

import socket
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .acts import field, until
from .conftest import Project, copy_jiwy
from .served import Served

Open = Callable[..., Any]
SECRET = "sessionStorage.getItem('epg-secret')"


def locked(page: Any, reason: str) -> Any:
    return page.get_by_role("alert").get_by_text(reason)


def test_the_key_stays_in_the_tab(jiwy: Project, open_page: Open) -> None:
    address = jiwy.address
    page = open_page(address)
    site, _, token = address.partition("#")
    assert page.url == site and token not in page.evaluate("document.documentElement.outerHTML")
    secret = page.evaluate(SECRET)
    assert len(secret) >= 32 and secret != token
    assert page.evaluate("document.cookie + JSON.stringify(localStorage)") == "{}"
    assert page.evaluate("history.length") <= 2, "about:blank, and one entry that has no token"
    page.go_back()
    page.go_forward()
    page.locator("#header .brand").wait_for()
    page.reload()
    field(page, "position_tilt").wait_for()
    assert (page.url, page.evaluate(SECRET)) == (site, secret)


def test_an_address_that_was_used_says_so(jiwy: Project, browser: Any, open_page: Open) -> None:
    address = jiwy.address
    open_page(address)
    site = address.partition("#")[0]
    page = browser.new_context().new_page()
    for used, reason in ((address, "This address was already used"), (site, "opened without the key")):
        page.goto("about:blank")
        page.goto(used)
        locked(page, reason).wait_for()
        assert page.locator(".diagram").count() == 0 and page.url == site

    # The next address in the same tab: the browser does not reload the page.
    page.goto(jiwy.address)
    field(page, "position_tilt").wait_for()
    assert page.url == site and page.get_by_role("alert").count() == 0
    page.context.close()


def test_a_page_of_an_epg_that_has_ended(browser: Any, tmp_path: Path) -> None:
    copy_jiwy(tmp_path / "jiwy")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = str(free.getsockname()[1])
    with Served(tmp_path / "jiwy", "--port", port) as epg:
        page = browser.new_context().new_page()
        page.goto(epg.address)
        field(page, "position_tilt").wait_for()
    with Served(tmp_path / "jiwy", "--port", port) as epg:
        locked(page, "EPG was restarted").wait_for()
        assert page.evaluate(SECRET) is None
        page.goto(epg.address)
        until(page, "document.querySelectorAll('[role=alert]').length === 0")
        field(page, "position_tilt").select_option("encoder_pan")
        page.get_by_text("● Unsaved").wait_for()
    page.context.close()


def test_a_picture_by_itself(jiwy: Project, open_page: Open) -> None:
    page = open_page(jiwy.address)
    page.get_by_role("tab", name="Application").click()
    until(page, "document.querySelector('img.picture')?.naturalWidth > 0")
    with page.context.expect_page() as opening:
        page.get_by_role("link", name="Open in a new tab").click()
    alone = opening.value
    alone.wait_for_load_state()
    assert alone.url.startswith("blob:http://127.0.0.1:")
    assert alone.evaluate("document.documentElement.localName") == "svg"
    assert alone.locator("text", has_text="position_pan").count() > 0
    fill = "getComputedStyle(document.querySelector('rect.back')).fill"
    assert alone.evaluate(fill) == "rgb(255, 255, 255)", "the picture's own style counts"
    assert alone.evaluate(SECRET) is None, "a picture is not a page of EPG"
