# SPDX-License-Identifier: Apache-2.0
"""Members of a hand-written model that hold fewer numbers than a double: each number becomes the nearest possible one.

The model copies its inputs and its parameters to outputs of the same types.
"""

from __future__ import annotations

import csv
import json
import math
import re
import shutil
import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

import pytest
import yaml

from tests.models.harness import Library, build, load, loaded, run, run_program

CART = Path(__file__).resolve().parents[2] / "simulate" / "cart"
EXACT = 2.0**53
FLOAT = struct.unpack("<f", struct.pack("<I", 0x7F7FFFFF))[0]


@dataclass(frozen=True)
class Member:
    """The type of a member in C, the ends of its range, and the width of a bit-field."""

    name: str
    type: str
    low: float
    high: float
    width: str = ""

    @property
    def declared(self) -> str:
        return f"    {self.type} {self.name}{self.width};\n"

    def nearest(self, value: float) -> tuple[float, bool]:
        """The number that the member must hold, and True if the value was outside of its range."""
        if self.type == "double":
            return value, False
        if self.type == "float":
            outside = abs(value) > FLOAT
            return (math.copysign(FLOAT, value) if outside else struct.unpack("f", struct.pack("f", value))[0]), outside
        whole = math.copysign(float(math.floor(Fraction(abs(value)) + Fraction(1, 2))), value)
        return min(max(whole, self.low), self.high), not self.low <= whole <= self.high


MEMBERS = [
    Member("i8", "int8_t", -128, 127),
    Member("u8", "uint8_t", 0, 255),
    Member("i16", "int16_t", -32768, 32767),
    Member("u16", "volatile unsigned short", 0, 65535),
    Member("i32", "int", -(2.0**31), 2.0**31 - 1),
    Member("u32", "uint32_t", 0, 2.0**32 - 1),
    Member("i64", "int64_t", -EXACT, EXACT),
    Member("u64", "unsigned long long", 0, EXACT),
    Member("single", "float", -FLOAT, FLOAT),
    Member("real", "double", -math.inf, math.inf),
    Member("flag", "bool", 0, 1),
    Member("bits", "unsigned int", 0, 7, " : 3"),
    Member("more", "signed char", -8, 7, " : NIBBLE"),
    Member("long_bits", "uint64_t", 0, EXACT, " : 60"),
]

VALUES = [
    *(0.0, 0.3, 0.49999999999999994, 0.5, 1.5, 2.5, -0.3, -0.5, -1.5, 6.5, 7.4, 7.5, 8.0, -8.4, -8.5, 44.0, 300.0),
    *(127.4, 127.5, 255.49, 255.5, -128.5, 32767.4, 32767.5, 40000.0, -32768.5, 65535.5, 2147483647.4, 2147483647.5),
    *(-2147483648.5, 4294967295.5, 4.6e15, EXACT - 1, EXACT, EXACT + 2, -EXACT, -EXACT - 2, 2.0**63, 2.0**64),
    *(1e39, -1e39, 3.4e38, 1e-46, 1e300, -1e300),
]

HEADER = """#pragma once
#include <stdbool.h>
#include <stdint.h>
#define NIBBLE 4
typedef struct {{
{members}}} ports_t;
typedef struct {{
{members}    int steps;
}} narrow_t;
void narrow_step(narrow_t *self, const ports_t *in, ports_t *out);
"""

SOURCE = """#include "narrow.h"
void narrow_step(narrow_t *self, const ports_t *in, ports_t *out)
{{
    self->steps++;
{copies}}}
"""


ATTRIBUTE = "__attribute__((packed))"
MACRO = "#define __packed __attribute__((__packed__))"
PACKED = {
    "pragma": lambda text: text.replace("typedef", "#pragma pack(1)\ntypedef", 1) + "#pragma pack()\n",
    "behind": lambda text: re.sub(r"^} ", f"}} {ATTRIBUTE} ", text, flags=re.MULTILINE),
    "before": lambda text: text.replace("struct {", f"struct {ATTRIBUTE} {{"),
    "macro": lambda text: text.replace("struct {", "struct __packed {").replace("typedef", f"{MACRO}\ntypedef", 1),
    "members": lambda text: re.sub(r"^(    .*);", rf"\1 {ATTRIBUTE};", text, flags=re.MULTILINE),
}


def write(
    folder: Path,
    language: str,
    port_type: str = "real",
    pack: Callable[[str], str] = str,
    **changes: object,
) -> Path:
    """A model with one input and one parameter for each member, and outputs of the same types."""
    folder.mkdir(parents=True)
    suffix = {"c": "c", "c++": "cpp"}[language]
    members = "".join(member.declared for member in MEMBERS)
    (folder / "narrow.h").write_text(pack(HEADER.format(members=members)))
    copy = "    if (self->steps > 1) out->{0} = self->{0}; else out->{0} = in->{0};\n"
    copies = "".join(copy.format(member.name) for member in MEMBERS)
    (folder / f"narrow.{suffix}").write_text(SOURCE.format(copies=copies))
    inputs, outputs = ({member.name: {"type": port_type} for member in MEMBERS} for _ in range(2))
    document = {
        "version": 1,
        "step": "1 ms",
        "language": language,
        "header": "narrow.h",
        "sources": [f"narrow.{suffix}"],
        "instance": "narrow_t",
        "types": {"inputs": "ports_t", "outputs": "ports_t"},
        "functions": {"step": "narrow_step"},
        "inputs": inputs,
        "outputs": outputs,
        "parameters": {f"p_{member.name}": {"value": 0, "member": member.name} for member in MEMBERS},
        **changes,
    }
    (folder / "model.yaml").write_text(yaml.safe_dump(document, sort_keys=False))
    return folder


def main(body: str, values: list[str]) -> str:
    fields = "\n".join(f"        in.{member.name} = value;" for member in MEMBERS)
    tunes = "\n".join(f"        n_set_parameter(self, N_P_{member.name.upper()}, value);" for member in MEMBERS)
    shows = "\n".join(f'        printf("%.17g ", out.{member.name});' for member in MEMBERS)
    return f"""
#include "n.h"
#include <math.h>
#include <stdio.h>
int main(void)
{{
    static const double values[] = {{{", ".join(values)}}};
    n_t *self = n_instance(0);
    n_inputs_t in;
    n_outputs_t out = {{0}};
    (void)values;
{body.replace("INPUTS", fields).replace("PARAMETERS", tunes).replace("SHOW", shows)}
    return 0;
}}
"""


def rows(
    library: Library, body: str, folder: Path, values: list[str], options: tuple[str, ...] = ()
) -> list[list[float]]:
    text = run_program(folder, main(body, values), [library], options)
    return [[float(word) for word in line.split()] for line in text.splitlines()]


EACH = """
    for (unsigned i = 0; i < sizeof values / sizeof values[0]; i++) {
        const double value = values[i];
        unsigned long before;
INPUTS
        n_init(self, &in, &out);
        before = n_clamped(self);
        n_step(self, &in, &out);
SHOW
        printf("%lu %d\\n", n_clamped(self) - before, n_finite(self));
        before = n_clamped(self);
PARAMETERS
        for (unsigned k = 0; k < sizeof in / sizeof(double); k++) {
            ((double *)&in)[k] = 0.0;
        }
        n_step(self, &in, &out);
SHOW
        printf("%lu %d\\n", n_clamped(self) - before, n_finite(self));
    }
"""
SANITIZE = ("-fsanitize=float-cast-overflow,undefined", "-fno-sanitize-recover=all")


@pytest.mark.parametrize("port_type", ["real", "integer"])
@pytest.mark.parametrize("language", ["c", "c++"])
def test_each_number_becomes_the_nearest_one_of_the_range(language: str, port_type: str, tmp_path: Path) -> None:
    model = loaded(write(tmp_path / "model", language, port_type))
    library = build(model, "n", tmp_path, options=SANITIZE)
    found = rows(library, EACH, tmp_path, [repr(value) for value in VALUES], SANITIZE)
    assert len(found) == 2 * len(VALUES)
    for value, inputs, parameters in zip(VALUES, found[::2], found[1::2], strict=True):
        for row, kind in ((inputs, port_type), (parameters, "real")):
            expected = [member.nearest(rounded(value) if kind == "integer" else value) for member in MEMBERS]
            assert row[:-2] == [number for number, _ in expected], value
            assert row[-2:] == [sum(outside for _, outside in expected), 1], value


@pytest.mark.parametrize("packing", PACKED)
@pytest.mark.parametrize("language", ["c", "c++"])
def test_members_can_be_packed(language: str, packing: str, tmp_path: Path) -> None:
    """A reference to such a member would not compile, or would not be aligned."""
    model = loaded(write(tmp_path / "model", language, pack=PACKED[packing]))
    library = build(model, "n", tmp_path, options=SANITIZE)
    found = rows(library, EACH, tmp_path, [repr(value) for value in VALUES], SANITIZE)
    for value, inputs, parameters in zip(VALUES, found[::2], found[1::2], strict=True):
        expected = [member.nearest(value)[0] for member in MEMBERS]
        assert inputs[:-2] == parameters[:-2] == expected, value


def rounded(value: float) -> float:
    """The value of an integer port: whole, also in a double."""
    return Member("any", "int64_t", -math.inf, math.inf).nearest(value)[0]


@pytest.mark.parametrize("options", [(), ("-O2", "-ffast-math")], ids=["plain", "fast-math"])
@pytest.mark.parametrize("language", ["c", "c++"])
def test_nan_is_not_an_end_of_a_range(language: str, options: tuple[str, ...], tmp_path: Path) -> None:
    body = """
    double value = 1.0;
INPUTS
    n_init(self, &in, &out);
    n_step(self, &in, &out);
    printf("%d %g %lu\\n", n_finite(self), out.u8, n_clamped(self));
    value = 2.0;
INPUTS
    in.flag = 1.0;
    in.MEMBER = values[0];
    n_step(self, &in, &out);
    printf("%d %g %lu\\n", n_finite(self), out.u8, n_clamped(self));
    in.MEMBER = POSSIBLE;
    n_set_parameter(self, N_P_U8, 9.0);
    n_step(self, &in, &out); /* the second step shows parameters: the one with NaN was not taken */
    printf("%d %g %lu\\n", n_finite(self), out.u8, n_clamped(self));
    n_set_parameter(self, N_P_U8, 11.0);
    n_set_parameter(self, N_P_MEMBER, values[0]);
    printf("%d\\n", n_finite(self));
    n_step(self, &in, &out);
    n_step(self, &in, &out);
    printf("%d %g %lu\\n", n_finite(self), out.u8, n_clamped(self));
    n_init(self, &in, &out);
    n_step(self, &in, &out);
    printf("%d %g\\n", n_finite(self), out.u8);
"""
    library = build(loaded(write(tmp_path / "model", language)), "n", tmp_path, options=options)
    for member in MEMBERS:
        if member.type != "double":
            text = body.replace("_MEMBER", f"_{member.name.upper()}").replace("MEMBER", member.name)
            text = text.replace("POSSIBLE", "1.0" if member.name == "flag" else "2.0")
            found = rows(library, text, tmp_path, ["(double)NAN"])
            assert found == [[1, 1, 0], [0, 1, 0], [1, 9, 0], [0], [0, 9, 0], [1, 2]], member.name


def test_nan_at_the_start_needs_another_start(tmp_path: Path) -> None:
    """A model that was not initialised must not run."""
    folder = write(tmp_path / "model", "c", functions={"init": "narrow_step", "step": "narrow_step"})
    body = """
    double value = 3.0;
INPUTS
    in.i16 = values[0];
    n_init(self, &in, &out);
    printf("%d %g\\n", n_finite(self), out.u8);
    in.i16 = 3.0;
    n_step(self, &in, &out);
    printf("%d %g\\n", n_finite(self), out.u8);
    n_init(self, &in, &out);
    printf("%d %g\\n", n_finite(self), out.u8);
"""
    found = rows(build(loaded(folder), "n", tmp_path), body, tmp_path, ["(double)NAN"])
    assert found == [[0, 0], [0, 0], [1, 3]]


def test_a_double_member_holds_nan_and_infinity(tmp_path: Path) -> None:
    body = """
    for (unsigned i = 0; i < 2; i++) {
        double value = 0.0;
INPUTS
        in.real = values[i];
        n_init(self, &in, &out);
        n_step(self, &in, &out);
        printf("%d %d %lu\\n", out.real == values[i] || out.real != out.real, n_finite(self), n_clamped(self));
    }
"""
    found = rows(
        build(loaded(write(tmp_path / "model", "c")), "n", tmp_path), body, tmp_path, ["(double)NAN", "HUGE_VAL"]
    )
    assert found == [[1, 0, 0], [1, 0, 0]]


@pytest.mark.parametrize("language", ["c", "c++"])
def test_outputs_of_64_bits_are_whole_numbers_that_a_double_has(language: str, tmp_path: Path) -> None:
    folder = write(tmp_path / "model", language)
    path = next(folder.glob("narrow.c*"))
    path.write_text(
        path.read_text()
        .replace("in->i64", "INT64_MIN")
        .replace("in->u64", "UINT64_MAX")
        .replace("in->long_bits", "(1ull << 53) + 1")
    )
    body = """
    double value = 0.0;
INPUTS
    n_init(self, &in, &out);
    n_step(self, &in, &out);
    printf("%.17g %.17g %.17g %lu\\n", out.i64, out.u64, out.long_bits, n_clamped(self));
"""
    found = rows(build(loaded(folder), "n", tmp_path), body, tmp_path, ["0.0"])
    assert found == [[-EXACT, EXACT, EXACT, 3]]


ENUMERATIONS = {"c": ("enum speed { SLOW, FAST };", "enum speed"), "c++": ("enum class Speed : int8_t {};", "Speed")}


@pytest.mark.parametrize("language", sorted(ENUMERATIONS))
def test_an_enumeration_has_the_range_of_its_integer_type(language: str, tmp_path: Path) -> None:
    folder = write(tmp_path / "model", language)
    header = folder / "narrow.h"
    declared, name = ENUMERATIONS[language]
    text = header.read_text().replace("int8_t i8;", f"{name} i8;")
    header.write_text(text.replace("#define NIBBLE", f"{declared}\n#define NIBBLE"))
    body = """
    double value = 0.0;
INPUTS
    n_init(self, &in, &out);
    in.i8 = -1000.0;
    n_set_parameter(self, N_P_I8, 1.6);
    for (int i = 0; i < 2; i++) {
        n_step(self, &in, &out);
        printf("%.17g %.17g %lu\\n", out.i8, n_get_parameter(self, N_P_I8), n_clamped(self));
    }
"""
    found = rows(build(loaded(folder), "n", tmp_path), body, tmp_path, ["0.0"])
    assert found == [[0 if language == "c" else -128, 2, 1], [2, 2, 2]]


WRONG = [
    ("NIBBLE 4", "NIBBLE (2 + 2)", "the width of bit-field 'more' is not a number: 'NIBBLE'"),
    ("signed char more", "char more", "the type of bit-field 'more' does not tell its range: 'char'"),
    ("signed char more", "mode_t more", "the type of bit-field 'more' does not tell its range: 'mode_t'"),
]


@pytest.mark.parametrize(("old", "new", "message"), WRONG, ids=[new for _, new, _ in WRONG])
def test_a_bit_field_without_a_clear_range_is_an_error(old: str, new: str, message: str, tmp_path: Path) -> None:
    folder = write(tmp_path / "model", "c")
    header = folder / "narrow.h"
    assert old in header.read_text()
    header.write_text(header.read_text().replace(old, new))
    model, diagnostics = load(folder)
    assert model is None
    assert {(item.id, item.message) for item in diagnostics} == {("wrong-value", message)}
    assert all(item.hint and item.span.line > 1 for item in diagnostics)


@pytest.mark.parametrize("language", ["c", "c++"])
def test_a_bit_field_that_epg_does_not_see_does_not_compile(language: str, tmp_path: Path) -> None:
    """The compiler alone would tell the range of its type, which is wider."""
    folder = write(tmp_path / "model", language)
    header = folder / "narrow.h"
    header.write_text(
        header.read_text()
        .replace("unsigned int bits : 3;", "BITS(bits, 3);")
        .replace("#define", "#define BITS(name, n) unsigned int name : n\n#define")
    )
    with pytest.raises(AssertionError, match=r"bit-field|cannot bind"):
        build(loaded(folder), "n", tmp_path)


def test_a_parameter_outside_of_its_type_is_an_error(tmp_path: Path) -> None:
    parameters = {"u8": 300, "bits": 8, "i16": -32768, "single": 1}
    model, diagnostics = load(write(tmp_path / "model", "c", parameters=parameters))
    assert model is None
    assert [item.message for item in diagnostics] == [
        "300 is outside of the range of 'u8', which is 0 to 255",
        "8 is outside of the range of 'bits', which is 0 to 7",
    ]


def test_a_target_counts_the_values_that_its_model_cannot_hold(tmp_path: Path) -> None:
    if not shutil.which("cmake"):
        pytest.skip("CMake is not installed: sudo apt install cmake")
    project = tmp_path / "cart"
    shutil.copytree(CART, project)
    changes = {
        "cart.cmake": ("${CMAKE_CURRENT_LIST_DIR}/../../..", CART.parents[2].as_posix()),
        "controller/controller.h": ("double setpoint;", "short setpoint;"),
        "controller/controller.c": ("inputs->setpoint / 20.0", "inputs->setpoint == 32767 ? 0.25 : 0.0"),
    }
    for file, (old, new) in changes.items():
        text = (project / file).read_text()
        assert old in text
        (project / file).write_text(text.replace(old, new))
    generator = ["-G", "Ninja"] if shutil.which("ninja") else []
    run(
        [
            "cmake",
            "-S",
            str(project),
            "-B",
            str(tmp_path / "build"),
            *generator,
            f"-DPython3_EXECUTABLE={sys.executable}",
        ]
    )
    run(["cmake", "--build", str(tmp_path / "build")])
    (tmp_path / "in.csv").write_text("time,topic,value\n0,$enable,1\n0.5,speed,40000\n")
    files = ["--setpoints", tmp_path / "in.csv", "--trace", tmp_path / "out.csv", "--statistics", tmp_path / "out.json"]
    run([str(word) for word in (tmp_path / "build/cart_host", "--quiet", "--duration", "1", *files)])
    with (tmp_path / "out.csv").open(newline="") as file:
        duties = [float(row["outputs.duty"]) for row in csv.DictReader(file)]
    assert duties[499] == 0.0 and set(duties[501:]) == {0.25}
    assert json.loads((tmp_path / "out.json").read_text())["clamped"] == sum(duty != 0.0 for duty in duties)
