# SPDX-License-Identifier: Apache-2.0
"""Topics as C: what ``templates/topics.c.j2`` lays out, with the messages that the templates of kinds name.

A kind's ``code.c.j2`` says its message by macros: ``message(c)`` (an ``epg_message_t``), ``message_type(c)`` (as ROS
names it), ``message_size(c)`` (bytes of the largest one) and ``layout(c)`` (what the message's functions want to know).
Kinds without them are of std_msgs/msg/Float64.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass

from epg.emit.text import Code
from epg.resolve.application import Application, ResolvedComponent, Topic

Macro = Callable[..., Code]
"""``macro(component, name, *arguments)``: what the template of a component's kind gives; empty when it has no such."""


@dataclass(frozen=True)
class TopicView:
    """A topic with its message; ``ros_type`` is text, ``size`` a C expression, ``layout`` empty for none."""

    topic: Topic
    message: Code
    ros_type: str
    size: Code
    layout: Code

    @property
    def value_names(self) -> Sequence[str]:
        """Names of the values, if they are not called as the topic."""
        names = [value.name for value in self.topic.values]
        return names if names != [self.topic.name] else []


@dataclass(frozen=True)
class Topics:
    """All topics of an application.

    ``largest`` and ``largest_received`` are C expressions for the bytes of the largest message that is published and
    of the largest that is expected.
    """

    subscriptions: tuple[TopicView, ...]
    publications: tuple[TopicView, ...]
    setpoint_count: int
    monitor_count: int
    largest: Code
    largest_received: Code
    most_received: int

    @property
    def has_changes(self) -> bool:
        """Whether a publication is sent when its values have changed."""
        return any(view.topic.trigger == "change" for view in self.publications)


_FIXED = {
    "enable": (Code("epg_message_bool"), "std_msgs/msg/Bool", Code("1")),
    "diagnostics": (
        Code("epg_message_diagnostic_array"),
        "diagnostic_msgs/msg/DiagnosticArray",
        Code("EPG_DIAGNOSTICS_SIZE"),
    ),
}


def topics_of(app: Application, macro: Macro) -> Topics:
    """The topics of ``app``."""
    subscriptions = tuple(_view(topic, macro) for topic in app.subscriptions)
    publications = tuple(_view(topic, macro) for topic in app.publications)
    return Topics(
        subscriptions=subscriptions,
        publications=publications,
        setpoint_count=sum(len(topic.values) for topic in app.subscriptions),
        monitor_count=sum(len(topic.values) for topic in app.publications),
        largest=_largest(publications),
        largest_received=_largest(subscriptions),
        most_received=max((len(topic.values) for topic in app.subscriptions), default=0) or 1,
    )


def _view(topic: Topic, macro: Macro) -> TopicView:
    if topic.component is None:
        message, ros_type, size = _FIXED[topic.role]
        return TopicView(topic, message, ros_type, size, Code(""))
    return TopicView(topic, *message_of(topic.component, macro))


def message_of(component: ResolvedComponent, macro: Macro) -> tuple[Code, str, Code, Code]:
    """Message, type, size and layout of a component's topic."""
    message = macro(component, "message").strip()
    if not message:
        if len(component.value_index) > 1:
            raise LookupError(f"kind '{component.kind.name}' has several values and no macro 'message'")
        return Code("epg_message_float64"), "std_msgs/msg/Float64", Code("8"), Code("")
    size = macro(component, "message_size").strip()
    if not str(size).isdecimal():
        raise LookupError(
            f"kind '{component.kind.name}' has a message, and no macro 'message_size' that gives its size"
        )
    return message, str(macro(component, "message_type").strip()), size, macro(component, "layout").strip()


def _largest(topics: Iterable[TopicView]) -> Code:
    sizes = [view.size for view in topics]
    largest = max((int(str(size)) for size in sizes if str(size).isdecimal()), default=8)
    others = {size for size in sizes if not str(size).isdecimal()}
    if not others:
        return Code(str(largest))
    (other,) = others
    return Code(f"{other} > {largest} ? {other} : {largest}") if largest > 8 else other
