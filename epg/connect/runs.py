# SPDX-License-Identifier: Apache-2.0
"""The build of a session: the running one, or the last one."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from epg.check.configuration import Configuration
from epg.connect.body import Refused
from epg.connect.build.consent import Question, question_about
from epg.connect.build.run import Build
from epg.connect.places import Places
from epg.connect.projects import Job
from epg.source import Span


class Runs:
    """Starts, cancels and shows builds, one at a time.

    ``changed`` is called, by any thread, when there is something new to show.
    """

    def __init__(self, changed: Callable[[], None]) -> None:
        self._changed = changed
        self._build = Build(changed)
        self._question: Question | None = None

    @property
    def running(self) -> bool:
        return self._build.is_running

    def check_idle(self) -> None:
        if self.running:
            raise Refused("a build is running", "wait for it, or cancel it", 409)

    def ask(
        self, job: Job, configuration: Configuration | None, agreed: str, *, anyway: bool = False
    ) -> dict[str, Any] | None:
        """The question that the user must agree to before the build; None if there is no question left.

        ``agreed`` is the key of a question that the user has answered with yes.
        """
        self._question = question_about(job, configuration, anyway=anyway)
        if self._question is not None and self._question.key == agreed:
            self._question.agree()
            self._question = None
        return self._question.data() if self._question is not None else None

    def start(self, job: Job, *, anyway: bool = False) -> None:
        """Configures and builds ``job``.  Raises Refused while another build runs."""
        self.check_idle()
        self._build = Build(self._changed)
        self._build.start(job, anyway=anyway)

    def cancel(self) -> None:
        self._build.cancel()

    def close(self) -> None:
        """Cancels a running build, and waits at most 10 s for its end."""
        self.cancel()
        self._build.wait(10)

    def forget(self) -> None:
        self._build, self._question = Build(self._changed), None

    def state(self, places: Places | None) -> dict[str, Any]:
        """The state of the build for the page.  A message about the bindings gets the port that it is about."""
        state = self._build.state() | {"ask": self._question.data() if self._question is not None else None}
        for message in state["messages"] if places is not None else ():
            assert places is not None
            message["port"] = places.port_at(Span(message["file"], message["line"], message["column"]))
        return state

    def lines(self, start: int) -> list[str]:
        """The printed lines from line ``start`` on."""
        return self._build.lines(start)
