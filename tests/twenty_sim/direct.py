# SPDX-License-Identifier: Apache-2.0
"""A program around the generated C, written as a user without EPG would write it."""

from __future__ import annotations

import math
from pathlib import Path

from tests.models.harness import SIGNAL, STRICT, compile_file, link, run, values


def compile_export(folder: Path, name: str, work: Path, compiler: str = "c") -> Path:
    """The object file of the generated source, with warnings as errors."""
    return compile_file(folder / f"{name}.c", work / f"{name}.o", [*STRICT, f"-I{folder}"], compiler)


def run_export(folder: Path, name: str, work: Path, counts: tuple[int, int], steps: int) -> str:
    """The bits of all outputs of every step, with the inputs that all test programs use."""
    inputs, outputs = counts
    take = f"for (int i = 0; i < {inputs}; i++) {{ u[i] = ({name}_real)signal(); }}"
    show = f'for (int i = 0; i < {outputs}; i++) {{ show((double)y[i]); }} puts("");'
    return run_program(
        f"""{SIGNAL}
#include "{name}.h"
int main(void)
{{
    static {name}_ModelInstance model;
    {name}_real u[{inputs} + 1] = {{0}};
    {name}_real y[{outputs} + 1] = {{0}};
    {name}_ModelInitialize(&model);
    {take}
    {name}_InitializeSubmodel(&model, u, y, 0);
    {show}
    for (int k = 0; k < {steps}; k++) {{
        {take}
        {name}_CalculateSubmodel(&model, u, y);
        {show}
    }}
    {name}_TerminateSubmodel(&model, u, y);
    {show}
    return 0;
}}
""",
        folder,
        name,
        work,
    )


def run_program(text: str, folder: Path, name: str, work: Path) -> str:
    """The output of the program ``text``, linked with the generated source."""
    work.mkdir(parents=True, exist_ok=True)
    main = work / "main.c"
    main.write_text(text, encoding="utf-8")
    objects = [compile_file(main, work / "main.o", ["-w", f"-I{folder}"], "c"), compile_export(folder, name, work)]
    return run([str(link(objects, work / "program", False))])


def difference(one: str, other: str) -> str:
    """The first line in which two runs differ, or empty.  pytest's own comparison takes minutes."""
    if one == other:
        return ""
    pairs = zip(one.splitlines(), other.splitlines(), strict=False)
    return next((f"line {i}: {a} | {b}" for i, (a, b) in enumerate(pairs) if a != b), "one is longer")


def close(one: str, other: str, tolerance: float) -> bool:
    """True if two runs differ only by rounding: by ``tolerance``, relative or absolute."""
    rows = zip(values(one), values(other), strict=True)
    pairs = (pair for row in rows for pair in zip(*row, strict=True))
    return all(math.isclose(a, b, rel_tol=tolerance, abs_tol=tolerance) for a, b in pairs)
