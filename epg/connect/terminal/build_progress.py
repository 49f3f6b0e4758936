# SPDX-License-Identifier: Apache-2.0
"""Shows a build in the terminal: one line of progress, then the messages, the products and their use."""

from __future__ import annotations

from typing import Any

from epg.connect.json_data import State
from epg.connect.session import Session
from epg.connect.terminal.console import Console
from epg.connect.terminal.message import say_message

LOOK = 1.0
"""Seconds between two updates of the progress of a build without output."""
_OTHER_PLACES = "install these, or build anyway if the CMake files of the project find them in other places"


def ask_to_build(session: Session, console: Console) -> dict[str, Any] | None:
    """Asks for consent to a build, and shows its commands before the first build of a folder.

    If tools are missing, they are shown first.  Returns the body of the action "generate", or None if the user does not
    agree.
    """
    missing, can_try = session.missing_tools()
    for message in missing:
        say_message(message, session, console)
    if missing:
        console.say("the project cannot be built without these tools" if not can_try else _OTHER_PLACES)
        if not can_try or not console.agree("build anyway?", "n"):
            return None
    ask = session.build_question(anyway=bool(missing))
    if ask is not None:
        console.say(f"the build runs these commands in {ask['folder']}:")
        for command in ask["commands"]:
            console.say(f"  {command}")
        console.say(f"they start {', '.join(ask['programs'])}, and all programs that the project's CMake files start")
    if (not missing or ask is not None) and not console.agree("build?"):
        return None
    return {"run": ask["key"] if ask is not None else "", "anyway": bool(missing)}


def build(session: Session, console: Console, agreed: dict[str, Any]) -> bool:
    """Saves, configures and builds.  Ctrl-C cancels the build.  Returns True if it succeeded.  Raises Refused.

    ``agreed`` is the answer of :func:`ask_to_build`.
    """
    state = session.act("generate", agreed)
    said = ""
    while state["build"]["state"] == "running":
        try:
            now = state["build"]
            if not console.is_terminal and now["step"] != said:
                said = now["step"]
                console.say(f"{said} ...")
            console.over(_progress(now))
            state = session.wait(state["version"], LOOK)
        except KeyboardInterrupt:
            console.over("cancelling ...")
            state = session.act("cancel", {})
    console.clear()
    return _report(state, session, console)


def _progress(now: State) -> str:
    count = f" {now['done']}/{now['total']}" if now["total"] else ""
    return f"{now['step'] or 'starting'}{count}, {now['seconds']:.0f} s  {now.get('action', '')}"


def _report(state: State, session: Session, console: Console) -> bool:
    done = state["build"]
    for message in done["messages"]:
        say_message(message, session, console)
    if done["state"] != "done":
        console.say("the build was cancelled" if done["state"] == "cancelled" else "the build has failed")
        return False
    console.say(f"built in {done['seconds']:.0f} s")
    for product in done["products"]:
        console.say(product["path"])
        console.fill(product["what"], "  ")
    return True
