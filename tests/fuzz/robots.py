# SPDX-License-Identifier: Apache-2.0
"""Robots that are correct by construction: random components, wires, conversions and parameters with a suitable model.

Everything that :func:`robots` draws must generate and compile.  Names are as unusual as the rules allow.
"""

from __future__ import annotations

import json
import re
from dataclasses import dataclass, field
from typing import Any

from hypothesis import strategies as st

from epg.generator.check.names import STANDARD_HEADERS, identifier_problem
from epg.generator.models.identifiers import is_reserved

ARGUMENTS = ("--tcf", "robot.tcf", "--model", "model", "--bindings", "bindings.yaml")

#: Legal names that resemble illegal ones: macros, types, functions, names of generated files
ODD_NAMES = (
    "x", "x_config", "t", "h", "H", "inputs", "outputs", "start", "read", "model", "model_init", "plant", "values",
    "u", "y", "i", "index", "self", "samples", "signals", "setpoints", "application", "monitor", "fail_safe",
    "control", "target", "uint8", "size", "string", "stdio", "math", "pid", "time", "none", "made", "count", "robot",
    "robot_h", "ROBOT_H", "in", "out", "I", "NAN_", "a1", "start_", "xEPG_x", "_1", "_a", "x" * 63, "MODEL_x",
    "x_component", "get", "set", "get_x", "set_x", "write", "safe", "pwm", "constant",
)  # fmt: skip


def _usable(name: str) -> bool:
    return identifier_problem(name) is None and not is_reserved(name) and name not in STANDARD_HEADERS


names = st.one_of(
    st.sampled_from([name for name in ODD_NAMES if _usable(name)]),
    st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,11}", fullmatch=True).filter(_usable),
)
topics = st.from_regex(r"/?[A-Za-z][A-Za-z0-9]{0,5}(_[a-z0-9]{1,3})?(/[a-z][a-z0-9]{0,5}){0,2}", fullmatch=True)
numbers = st.one_of(
    st.floats(-1e6, 1e6, allow_subnormal=False),
    st.integers(-1000, 1000),
    st.sampled_from((0, 1, -1, 0.5, 1e-9, 123456789.123)),
)
positive = st.one_of(st.floats(1e-3, 1e6), st.integers(1, 100_000))
descriptions = st.one_of(
    st.just(""),
    st.text(max_size=20),
    st.sampled_from(("*/ int x; /*", "\\", "??/", "a\nb", '"', "// */", "é µ °", "%s", "{", "}")),
)


@dataclass(frozen=True)
class Component:
    """A component and the ports that it offers: ``(reference, direction, unit)``."""

    name: str
    text: dict[str, Any]
    ends: tuple[tuple[str, str, str], ...]


@dataclass
class Robot:
    """The files of a project for :class:`tests.fuzz.project.Project`, and the parts that they describe."""

    files: dict[str, bytes]
    components: list[Component] = field(default_factory=list)
    inputs: dict[str, str] = field(default_factory=dict)
    outputs: dict[str, str] = field(default_factory=dict)


@st.composite
def components(draw: st.DrawFn, name: str, topic: str) -> Component:
    """A component of any of EPG's own kinds."""
    kind = draw(
        st.sampled_from(
            [
                "quadrature_encoder",
                "pwm_h_bridge",
                "dual_pwm_h_bridge",
                "pwm",
                "digital_input",
                "digital_output",
                "constant",
                *ROS_KINDS,
            ]
        )
    )
    if kind in ROS_KINDS:
        return draw(ros_components(name, kind, topic))
    text: dict[str, Any] = {"kind": kind}
    flags = st.booleans()

    def maybe(key: str, strategy: st.SearchStrategy[Any]) -> None:
        if draw(flags):
            text[key] = draw(strategy)

    ends: tuple[tuple[str, str, str], ...]
    maybe("invert", flags) if kind != "constant" else None
    if kind == "quadrature_encoder":
        if draw(flags):
            text["counts_per_revolution"] = draw(positive)
            maybe("gear", st.sampled_from((1, "5625/361", 0.5, "1/3", 100)))
        else:
            text["span"] = {"counts": draw(positive), "angle": f"{draw(st.integers(1, 720))} deg"}
        maybe("preset", st.integers(-360, 360).map(lambda angle: f"{angle} deg"))
        ends = ((name, "source", "rad"), (f"{name}.reset", "sink", "boolean"))
    elif kind in ("pwm", "pwm_h_bridge", "dual_pwm_h_bridge"):
        maybe("frequency", st.sampled_from(("20 kHz", "1 kHz", "50 Hz", "1.5 kHz")))
        maybe("max_duty", st.floats(0.01, 1))
        if kind != "pwm":
            maybe("zero", st.sampled_from(("coast", "brake")))
            maybe("safe", st.sampled_from(("coast", "brake")))
            maybe("dead_time", st.sampled_from(("0 s", "10 us", "1 ms", "1 s")))
        ends = ((name, "sink", ""),)
    elif kind == "digital_input":
        maybe("pull", st.sampled_from(("none", "up", "down")))
        ends = ((name, "source", "boolean"),)
    elif kind == "digital_output":
        maybe("safe", flags)
        ends = ((name, "sink", "boolean"),)
    else:
        text["value"] = draw(numbers)
        ends = ((name, "source", ""),)
    if kind not in ("digital_input", "digital_output"):
        _conversion(draw, text)
    return Component(name, text, ends)


ROS_KINDS = (
    "ros_subscriber",
    "ros_publisher",
    "ros_array_subscriber",
    "ros_array_publisher",
    "ros_joint_state_subscriber",
    "ros_joint_state_publisher",
    "ros_twist_subscriber",
    "ros_twist_publisher",
    "ros_echo",
)
MESSAGES = ("Float64", "Float32", "Int32", "Bool")
JOINT = {"position": "rad", "velocity": "rad/s", "effort": "N.m"}


@st.composite
def ros_components(draw: st.DrawFn, name: str, kind: str, topic: str) -> Component:
    """A topic; ``topic`` is its name, or the beginning of its names."""
    text: dict[str, Any] = {"kind": kind}
    flags = st.booleans()

    def maybe(key: str, strategy: st.SearchStrategy[Any]) -> None:
        if draw(flags):
            text[key] = draw(strategy)

    qos = st.sampled_from(("reliable", "best_effort"))
    maybe("qos", qos)
    maybe("depth", st.integers(1, 1000))
    if kind in ("ros_subscriber", "ros_publisher", "ros_echo"):
        maybe("type", st.sampled_from(MESSAGES).flatmap(lambda m: st.sampled_from((m.lower(), f"std_msgs/msg/{m}"))))
    if kind == "ros_echo":
        text |= {"from": topic, "to": f"{topic}/echoed_back"}
        maybe("qos_from", qos)
        maybe("qos_to", qos)
        return Component(name, text, ())
    text["topic"] = topic
    direction = "source" if kind.endswith("subscriber") else "sink"
    if direction == "source":
        maybe("initial", numbers)
        maybe("rate_limit", positive)
        maybe("timeout", st.sampled_from(("0 s", "0.5 s", "20 ms", "1 min")))
        maybe("on_timeout", st.sampled_from(("hold", "zero", "disable")))
    elif draw(flags):
        maybe("every", st.integers(1, 1_000_000))
    else:
        maybe("on_change", flags)
    _conversion(draw, text)
    if direction == "source":
        text.pop("limits", None)  # with random initial values, they would be a mistake
    parts: list[tuple[str, str]] = [("", "")]
    if "array" in kind:
        text["values"] = draw(st.lists(names, min_size=1, max_size=5, unique_by=str.casefold))
        parts = [(value, "") for value in text["values"]]
    elif "joint" in kind:
        text["joints"] = draw(st.lists(names, min_size=1, max_size=4, unique_by=str.casefold))
        parts = [(f"{joint}.{part}", unit) for joint in text["joints"] for part, unit in JOINT.items()]
    elif "twist" in kind:
        maybe("stamped", flags)
        parts = [(f"{way}_{axis}", unit) for way, unit in (("linear", "m/s"), ("angular", "rad/s")) for axis in "xyz"]
    if kind == "ros_joint_state_publisher" or (kind == "ros_twist_publisher" and "stamped" in text):
        maybe("frame", st.sampled_from(("base_link", "", '"', "\\", "%s */ ~")))
    ends = [(f"{name}.{part}" if part else name, direction, unit) for part, unit in parts]
    return Component(name, text, tuple(ends))


@st.composite
def communications(draw: st.DrawFn) -> dict[str, Any]:
    """The communication of a host."""
    middleware = draw(st.sampled_from(("none", "files", "console", "dds", "xrce")))
    text: dict[str, Any] = {"middleware": middleware}

    def maybe(key: str, strategy: st.SearchStrategy[Any]) -> None:
        if draw(st.booleans()):
            text[key] = draw(strategy)

    maybe("period", st.sampled_from(("33 ms", "1 ms", "1 s")))
    if middleware in ("dds", "xrce"):
        maybe("console", st.booleans())
        maybe("diagnostics", st.sampled_from(("0 s", "1 s", "100 ms")))
        maybe("domain", st.integers(0, 232))
    if middleware == "xrce":
        text["transport"] = draw(st.sampled_from(("udp", "serial")))
        maybe("agent", st.sampled_from(("127.0.0.1:8888", "robot.local:1", "[::1]:65535")))
        maybe("device", st.sampled_from(("/dev/ttyUSB0", "", '/dev/"\\')))
        maybe("baud_rate", st.sampled_from((9600, 921600)))
        maybe("mtu", st.integers(384, 4096))
        maybe("history", st.sampled_from((2, 4, 8, 16)))
    return text


def _conversion(draw: st.DrawFn, text: dict[str, Any]) -> None:
    if draw(st.integers(0, 3)) == 0:
        text["scale"] = draw(st.sampled_from((2, -0.5, "1/3", "361/5625", 1e3, -1)))
    if draw(st.integers(0, 3)) == 0:
        text["offset"] = draw(numbers)
    if draw(st.integers(0, 3)) == 0:
        low = draw(st.integers(-100, 99))
        text["limits"] = [low, low + draw(st.integers(1, 100))]


@st.composite
def robots(draw: st.DrawFn, most: int = 8) -> Robot:
    """A project on the host: ``robot.tcf``, ``bindings.yaml`` and ``model/`` with a model written by hand."""
    found = draw(st.lists(names, min_size=1, max_size=most, unique_by=str.casefold))
    topic_names = draw(
        st.lists(topics, min_size=len(found), max_size=len(found), unique_by=lambda topic: topic.strip("/"))
    )
    parts = [draw(components(name, topic)) for name, topic in zip(found, topic_names)]
    sources = [end for part in parts for end in part.ends if end[1] == "source"]
    sinks = [end for part in parts for end in part.ends if end[1] == "sink"]
    wanted = draw(st.lists(st.sampled_from(sources), max_size=6)) if sources else []
    driven = draw(st.lists(st.sampled_from(sinks), max_size=6, unique=True)) if sinks else []
    ports = draw(st.lists(names, min_size=len(wanted) + 7, max_size=len(wanted) + 7, unique_by=str.casefold))
    inputs = dict(zip(ports, wanted))
    # several sinks may use the same output
    outputs: dict[str, list[tuple[str, str, str]]] = {ports[-1]: []}
    for sink in driven:
        outputs.setdefault(draw(st.sampled_from(ports[len(wanted) :])), []).append(sink)
    parameters = {name: draw(numbers) for name in draw(st.lists(names, max_size=3, unique_by=str.casefold))}
    control: dict[str, Any] = {"enable_at_start": draw(st.booleans())}
    if draw(st.booleans()):
        control["period"] = draw(st.sampled_from(("1 ms", "500 us", "0.25 ms", "2 ms")))
    tcf = {
        "version": 1,
        "target": "host",
        "node": draw(st.from_regex(r"[A-Za-z_][A-Za-z0-9_]{0,20}", fullmatch=True)),
        "control": control,
        "components": {part.name: part.text for part in parts},
    }
    if draw(st.booleans()):
        tcf["namespace"] = draw(topics)
    if draw(st.booleans()):
        tcf["communication"] = draw(communications())
    bindings: dict[str, Any] = {"version": 1, "model": "Random"}
    bindings["inputs"] = {name: _end(draw, end, "from") for name, end in inputs.items()}
    setpoints = {part.name for part in parts if str(part.text["kind"]).endswith("subscriber")}
    for value in bindings["inputs"].values():
        if isinstance(value, dict) and str(value["from"]).partition(".")[0] in setpoints:
            value.pop("limits", None)  # as above
    bindings["outputs"] = {
        name: [_end(draw, end, "to") for end in ends] if ends else "unconnected" for name, ends in outputs.items()
    }
    described = {
        name: {"description": draw(descriptions), **({"unit": end[2]} if end[2] not in ("", "boolean") else {})}
        for name, end in inputs.items()
    }
    model = {
        "version": 1,
        "name": "Random",
        "step": "2 ms",
        "header": "random.h",
        "sources": ["random.c"],
        "instance": "random_model_t",
        "functions": {"step": "random_step"},
        "types": {"outputs": "random_out_t", **({"inputs": "random_in_t"} if inputs else {})},
        "inputs": described,
        "outputs": {name: {"description": draw(descriptions)} for name in outputs},
        "parameters": {
            name: {"value": value, "member": f"p_{i}"} for i, (name, value) in enumerate(parameters.items())
        },
    }
    files = {
        "robot.tcf": yaml_text(tcf),
        "bindings.yaml": yaml_text(bindings),
        "model/model.yaml": yaml_text(model),
        "model/random.h": _header(list(inputs), list(outputs), len(parameters)),
        "model/random.c": _source(list(inputs), list(outputs)),
    }
    return Robot({name: text.encode() for name, text in files.items()}, parts)


def _end(draw: st.DrawFn, end: tuple[str, str, str], key: str) -> object:
    if draw(st.booleans()):
        return end[0]
    text: dict[str, Any] = {key: end[0]}
    _conversion(draw, text)
    return text


def yaml_text(value: dict[str, Any]) -> str:
    """A mapping as YAML: one line per key, with its value as JSON, which is also YAML."""
    lines = []
    for key, inner in value.items():
        if isinstance(inner, dict) and inner:
            lines.append(f"{key}:")
            lines += [f"  {_word(name)}: {_flow(child)}" for name, child in inner.items()]
        else:
            lines.append(f"{key}: {_flow(inner)}")
    return "\n".join(lines) + "\n"


def _flow(value: object) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_word(key)}: {_flow(child)}" for key, child in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_flow, value)) + "]"
    if isinstance(value, str):
        return (
            value
            if re.fullmatch(r"[A-Za-z][\w ./]*", value, re.ASCII) and value.casefold() not in _SPECIAL
            else _quoted(value)
        )
    return json.dumps(value)


def _quoted(text: str) -> str:
    """A string in double quotes, with escapes for the characters that YAML does not allow."""
    shown = (
        char if char.isprintable() else f"\\U{ord(char):08x}" for char in text.replace("\\", "\\\\").replace('"', '\\"')
    )
    return f'"{"".join(shown)}"'


_SPECIAL = ("true", "false", "null", "yes", "no", "on", "off", "y", "n")


def _word(key: str) -> str:
    return key if key.casefold() not in _SPECIAL else json.dumps(key)


def _header(inputs: list[str], outputs: list[str], parameters: int) -> str:
    def members(names_of_them: list[str]) -> str:
        return "".join(f" double {name};" for name in names_of_them)

    taken = "const random_in_t *in, " if inputs else ""
    kept = "".join(f" double p_{i};" for i in range(parameters))
    return (
        "#ifndef RANDOM_MODEL_HEADER_OF_TESTS\n#define RANDOM_MODEL_HEADER_OF_TESTS\n"
        + (f"typedef struct {{{members(inputs)} }} random_in_t;\n" if inputs else "")
        + f"typedef struct {{{members(outputs)} }} random_out_t;\n"
        + f"typedef struct {{ double state;{kept} }} random_model_t;\n"
        + f"void random_step(random_model_t *self, {taken}random_out_t *out);\n#endif\n"
    )


def _source(inputs: list[str], outputs: list[str]) -> str:
    taken = "const random_in_t *in, " if inputs else ""
    total = " + ".join([f"in->{name}" for name in inputs] or ["1.0"])
    lines = [f"    out->{name} = self->state;" for name in outputs]
    return (
        f'#include "random.h"\nvoid random_step(random_model_t *self, {taken}random_out_t *out)\n'
        f"{{\n    self->state = {total};\n" + "\n".join(lines) + "\n}\n"
    )
