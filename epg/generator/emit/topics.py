# SPDX-License-Identifier: Apache-2.0
"""The topics of an application with their messages, for ``templates/topics.c.j2``.

The ``code.c.j2`` of a kind names its message by macros: ``message(c)`` is an ``epg_message_t``, ``message_type(c)``
the name of the type in ROS, ``message_size(c)`` the bytes of the largest message, and ``layout(c)`` data for the
functions of the message.  A kind without these macros has the message std_msgs/msg/Float64.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from epg.generator.dataclass import dataclass
from epg.generator.emit.text import Code
from epg.generator.resolve.application import Application, ResolvedComponent, Topic
from epg.generator.resolve.parameter_sizes import event_size
from epg.generator.resolve.parameters import RosParameters

MacroText = Callable[..., Code]
"""``macro(component, name, *arguments)``: the text of a macro of the component's kind; empty if the kind has none."""


@dataclass(frozen=True)
class TopicView:
    """A topic with its message.

    ``ros_type`` is the name of the type in ROS.  ``size`` is a C expression in bytes.  ``layout`` is a C expression, or
    empty if the message does not need one.
    """

    topic: Topic
    message: Code
    ros_type: str
    size: Code
    layout: Code

    @property
    def value_names(self) -> Sequence[str]:
        """The names of the values; empty if there is one value with the name of the topic."""
        names = [value.name for value in self.topic.values]
        return names if names != [self.topic.name] else []


@dataclass(frozen=True)
class Topics:
    """All topics of an application.

    ``largest`` is a C expression for the bytes of the largest message that the target publishes, ``largest_received``
    for those of the largest message that it receives.  ``most_received`` is the largest number of values in one
    received message; it is at least 1.
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
        """True if at least one publication is sent when its values change."""
        return any(view.topic.trigger == "change" for view in self.publications)


_FIXED = {
    "enable": (Code("epg_message_bool"), "std_msgs/msg/Bool", Code("1")),
    "diagnostics": (
        Code("epg_message_diagnostic_array"),
        "diagnostic_msgs/msg/DiagnosticArray",
        Code("EPG_DIAGNOSTICS_SIZE"),
    ),
}


_EVENT = Code("epg_message_parameter_event")


def topics_of(app: Application, macro: MacroText) -> Topics:
    """The topics of ``app`` with their messages.  ``macro`` gives the texts of the kinds' macros."""
    subscriptions = tuple(_view(topic, macro, app.ros_parameters) for topic in app.subscriptions)
    publications = tuple(_view(topic, macro, app.ros_parameters) for topic in app.publications)
    return Topics(
        subscriptions=subscriptions,
        publications=publications,
        setpoint_count=sum(len(topic.values) for topic in app.subscriptions),
        monitor_count=sum(len(topic.values) for topic in app.publications),
        largest=_largest(publications),
        largest_received=_largest(subscriptions),
        most_received=max((len(topic.values) for topic in app.subscriptions), default=0) or 1,
    )


def _view(topic: Topic, macro: MacroText, parameters: RosParameters | None) -> TopicView:
    if topic.role == "parameters":
        size = Code(str(event_size(parameters)))
        return TopicView(topic, _EVENT, "rcl_interfaces/msg/ParameterEvent", size, Code("&parameter_event"))
    if topic.component is None:
        message, ros_type, size = _FIXED[topic.role]
        return TopicView(topic, message, ros_type, size, Code(""))
    return TopicView(topic, *message_of(topic.component, macro))


def message_of(component: ResolvedComponent, macro: MacroText) -> tuple[Code, str, Code, Code]:
    """The message, its type in ROS, its size and its layout, for the topic of a component.

    Raises LookupError if the kind of the component lacks a macro that its message needs.
    """
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
    """A C expression for the size of the largest message of ``topics``, in bytes; 8 if there are none."""
    sizes = [view.size for view in topics]
    largest = max((int(str(size)) for size in sizes if str(size).isdecimal()), default=8)
    others = {size for size in sizes if not str(size).isdecimal()}
    if not others:
        return Code(str(largest))
    (other,) = others
    return Code(f"{other} > {largest} ? {other} : {largest}") if largest > 8 else other
