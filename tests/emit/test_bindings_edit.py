"""Edits of bindings files: what changes, what stays as it was, and what is refused."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import pytest

from epg.diagnostics import Diagnostics
from epg.emit.bindings_edit import End, ends_of, set_ends
from epg.load.models.model import Model, Port
from epg.load.yaml_file import parse_yaml
from epg.source import Span

HERE = Span("model.yaml", 1, 1, 2)


def model(inputs: str, outputs: str) -> Model:
    ports = {
        direction: tuple(
            Port(name, f"port_{index}", direction, "", "real", index, HERE) for index, name in enumerate(names.split())
        )
        for direction, names in (("input", inputs), ("output", outputs))
    }
    return Model(
        "Servo", "hand-written", "c", "", "", Fraction(1, 1000), ports["input"], ports["output"], (), Path(), (), HERE
    )


SERVO = model("angle go setpoint", "duty log reset")

# Each: what is told, the port, its ends, the file before and after.
EXAMPLES: dict[str, tuple[str, tuple[End, ...] | None, str, str]] = {
    "another reference": (
        "angle",
        (End("button"),),
        "inputs:\n  # the load\n  angle:   encoder   # rad\n  go: button\n",
        "inputs:\n  # the load\n  angle:   button   # rad\n  go: button\n",
    ),
    "quotes stay": ("angle", (End("button"),), 'inputs: {"angle": "encoder"}\n', 'inputs: {"angle": "button"}\n'),
    "a conversion": (
        "angle",
        (End("encoder", "1/4", "-1.5", ("0", "3"), "rad/s"),),
        "inputs:\n  angle: encoder   # rad\n",
        "inputs:\n  angle: {from: encoder, scale: 1/4, offset: -1.5, limits: [0, 3], unit: rad/s}   # rad\n",
    ),
    "a conversion of an output": (
        "duty",
        (End("motor", limits=("-1", "1")),),
        "outputs:\n  duty: 'motor'\n",
        "outputs:\n  duty: {to: 'motor', limits: [-1, 1]}\n",
    ),
    "no conversion any more": (
        "angle",
        (End("encoder"),),
        "inputs:\n  angle: {from: encoder, scale: 1/4}   # rad\n",
        "inputs:\n  angle: encoder   # rad\n",
    ),
    "another key of a map in braces": (
        "angle",
        (End("encoder", "2", unit="rad"),),
        "inputs:\n  angle: { from: encoder , scale: 0.50 }\n",
        "inputs:\n  angle: { from: encoder , scale: 2, unit: rad }\n",
    ),
    "a number that is the same is left": (
        "angle",
        (End("button", "0.5"),),
        "inputs:\n  angle: {from: encoder, scale: 0.50}\n",
        "inputs:\n  angle: {from: button, scale: 0.50}\n",
    ),
    "a map over several lines": (
        "angle",
        (End("encoder", "1/8", "0", unit="rad"),),
        "inputs:\n  angle: {   # here\n    from: encoder,   # the load\n    # gear\n    scale: 1/4   # 1:4\n  }\n",
        "inputs:\n  angle: {   # here\n    from: encoder,   # the load\n    # gear\n    scale: 1/8,   # 1:4\n"
        "    offset: 0,\n    unit: rad\n  }\n",
    ),
    "a key out of a map over several lines": (
        "angle",
        (End("encoder"),),
        "inputs:\n  angle: {   # here\n    from: encoder,   # the load\n    # gear\n    scale: 1/4   # 1:4\n  }\n",
        "inputs:\n  angle: {   # here\n    from: encoder   # the load\n    # gear\n  }\n",
    ),
    "a map in block style": (
        "angle",
        (End("button", "1/4", "1", None, ""),),
        "inputs:\n  angle:   # here\n    # which one\n    from: encoder   # the load\n    # gear\n    scale: 2   # 1:2\n"
        "    limits:\n      - 0\n      - 1   # end\n    # at last\n  go: button\n",
        "inputs:\n  angle:   # here\n    # which one\n    from: button   # the load\n    # gear\n    scale: 1/4   # 1:2\n"
        "    offset: 1\n    # at last\n  go: button\n",
    ),
    "limits in block style": (
        "angle",
        (End("encoder", limits=("0", "2")),),
        "inputs:\n  angle:\n    from: encoder\n    limits:\n      - 0\n      - 1   # end\n",
        "inputs:\n  angle:\n    from: encoder\n    limits:\n      - 0\n      - 2   # end\n",
    ),
    "a second end": (
        "duty",
        (End("motor"), End("lamp", "2")),
        "outputs:\n  duty: motor   # main\n",
        "outputs:\n  duty: [motor, {to: lamp, scale: 2}]   # main\n",
    ),
    "a second end, lists in block style": (
        "duty",
        (End("motor"), End("lamp")),
        "outputs:\n  duty: motor   # main\n  log:\n  - a   # first\n  - b\n",
        "outputs:\n  duty:   # main\n  - motor\n  - lamp\n  log:\n  - a   # first\n  - b\n",
    ),
    "a second end of a map in block style": (
        "duty",
        (End("motor", "2"), End("lamp")),
        "outputs:\n  duty:   # main\n    # to\n    to: motor   # left\n\n    # gear\n    scale: 2\n  log: a\n",
        "outputs:\n  duty:   # main\n    # to\n    - to: motor   # left\n\n      # gear\n      scale: 2\n    - lamp\n"
        "  log: a\n",
    ),
    "an element out of the middle": (
        "log",
        (End("a"), End("c", "2")),
        "outputs:\n  log:\n    # first\n    - a   # 1\n    # second\n    - b   # 2\n    # third\n    - to: c   # 3\n",
        "outputs:\n  log:\n    # first\n    - a   # 1\n    # second\n    # third\n    - to: c   # 3\n      scale: 2\n",
    ),
    "one of two": ("log", (End("b"),), "outputs: {log: [a, b]}\n", "outputs: {log: b}\n"),
    "unconnected": (
        "log",
        (),
        "outputs:\n  log:   # here\n    - a\n    - b\n  reset: x\n",
        "outputs:\n  log: unconnected   # here\n  reset: x\n",
    ),
    "connected": ("log", (End("a"),), "outputs: {log: unconnected}\n", "outputs: {log: a}\n"),
    "in the place of its comment": (
        "log",
        (End("a"),),
        "outputs:\n  duty: motor\n  # log:    # no name matches; possible: a, b\n  # mine\n  reset: x\n",
        "outputs:\n  duty: motor\n  log: a\n  # mine\n  reset: x\n",
    ),
    "behind the comment of the port before": (
        "reset",
        (End("a"),),
        "outputs:\n  duty: motor\n  # log:    # no name matches; possible: a, b\n  # mine\n",
        "outputs:\n  duty: motor\n  # log:    # no name matches; possible: a, b\n  reset: a\n  # mine\n",
    ),
    "behind the port before": (
        "go",
        (End("button"),),
        "inputs:\n    setpoint: x\n    angle:\n        from: encoder\n        scale: 2   # gear\n\n    # end\n",
        "inputs:\n    setpoint: x\n    angle:\n        from: encoder\n        scale: 2   # gear\n    go: button\n\n    # end\n",
    ),
    "the first port": (
        "angle",
        (End("a"),),
        "inputs:   # in\n  # button\n  go: b\n",
        "inputs:   # in\n  angle: a\n  # button\n  go: b\n",
    ),
    "a section in braces": (
        "log",
        (End("a", "2"), End("b")),
        "outputs: {duty: motor, reset: x}   # out\n",
        "outputs: {duty: motor, log: [{to: a, scale: 2}, b], reset: x}   # out\n",
    ),
    "an empty section": (
        "log",
        (End("a"),),
        "inputs:\n    angle: x\noutputs: {}   # out\nparameters: {}\n",
        "inputs:\n    angle: x\noutputs:   # out\n    log: a\nparameters: {}\n",
    ),
    "no section": (
        "angle",
        (End("a"),),
        "# mine\noutputs: {log: b}\n",
        "inputs:\n  angle: a\n# mine\noutputs: {log: b}\n",
    ),
    "no section, and no line end": ("log", (End("a"),), "inputs:\n  go: b", "inputs:\n  go: b\noutputs:\n  log: a"),
    "a section as epg bind leaves it": (
        "go",
        (End("b"),),
        "# inputs:    # remove this '#' with the first below it\n  # angle:    # no name matches; possible: a, b\n"
        "  # go:    # no name matches; possible: a, b\n  # setpoint:    # no name matches; possible: a, b\noutputs: {}\n",
        "inputs:\n  # angle:    # no name matches; possible: a, b\n  go: b\n"
        "  # setpoint:    # no name matches; possible: a, b\noutputs: {}\n",
    ),
    "out": (
        "go",
        None,
        "inputs:\n  angle: a\n  # button\n  go:   # in\n    from: b   # here\n    # 2\n    scale: 2\n  # end\n",
        "inputs:\n  angle: a\n  # button\n  # end\n",
    ),
    "out, the last line without a line end": ("go", None, "inputs:\n  angle: a\n  go: b", "inputs:\n  angle: a"),
    "out, the last of a section": (
        "go",
        None,
        "inputs:   # in\n  # button\n  go: b   # here\noutputs: {}\n",
        "inputs: {}   # in\n  # button\noutputs: {}\n",
    ),
    "out of braces": ("go", None, "inputs: {angle: a, go: b}\n", "inputs: {angle: a}\n"),
    "a number that is none": (
        "angle",
        (End("a", "1,5", "010", ("yes", "0x10"), "1"),),
        "inputs: {angle: a}\n",
        "inputs: {angle: {from: a, scale: '1,5', offset: '010', limits: ['yes', 0x10], unit: '1'}}\n",
    ),
    "texts that would be something else": (
        "angle",
        (End("a\nb: c # d", "2\n", "# x", ("[", "]"), "{%"),),
        "inputs: {angle: a}\n",
        "inputs: {angle: {from: \"a\\u000Ab: c # d\", scale: 2, offset: '# x', limits: ['[', ']'], unit: '{%'}}\n",
    ),
}


def edited(text: str, port: str, ends: tuple[End, ...] | None, of: Model = SERVO) -> str:
    return set_ends(text, "servo.bindings.yaml", of, port, ends)


def said(text: str, port: str, of: Model = SERVO) -> tuple[End, ...] | None:
    root = parse_yaml(text, "servo.bindings.yaml", Diagnostics())
    assert root is not None
    return ends_of(root, "inputs" if port in [p.name for p in of.inputs] else "outputs", port)


@pytest.mark.parametrize("what", EXAMPLES)
def test_only_that_changes(what: str) -> None:
    port, ends, before, after = EXAMPLES[what]
    head = "# servo\nversion: 1\nmodel: Servo\n"
    assert edited(head + before, port, ends) == head + after
    assert edited(head + after, port, ends) == head + after, "a second time changes nothing"
    for line_end in ("\r\n", "\r"):
        changed = edited("\ufeff" + (head + before).replace("\n", line_end), port, ends)
        assert changed == "\ufeff" + (head + after).replace("\n", line_end)
