# SPDX-License-Identifier: Apache-2.0
"""FMUs give the same results in EPG's library as in FMPy, an ordinary importer that gets the same steps.

This is a test of ``check_long``, because FMPy needs numpy, lxml, CMake and more, some 200 MB.
"""

from __future__ import annotations

import math
import os
import random
import shutil
import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from epg.generator.importers.fmu.fmi_headers import fmi_functions, fmi_headers
from epg.generator.importers.fmu.fmu_export import FmuExport
from epg.generator.importers.fmu.fmu_files import is_fmu_folder
from tests.doubles.twenty_sim.exports import Export
from tests.models.fmus import FMU2, FMU3, listed_sources
from tests.models.harness import COMMON, build, load, run, run_program

STEPS = 1000
NEEDED = "FMPy is not installed: pip install -r epg/generator/lock/fmpy.txt"
DISCARD = 2  # the answer of an FMU of FMI 2.0 that ends
EXACT = "0.0009765625"  # a power of two: its sums are exact
FORMS = ("globals", "instance", "output time")
METHODS = ("Discrete", "Euler", "RungeKutta2", "RungeKutta4")


@pytest.fixture(scope="module")
def fmpy() -> Any:
    for module in ("fmpy.fmi2", "fmpy.fmi3"):
        pytest.importorskip(module, reason=NEEDED)
    return pytest.importorskip("fmpy", reason=NEEDED)


def compiled(folder: Path, target: Path) -> Path:
    """A copy of an FMU with a shared library, compiled as its own makefile would do it, without prefixes of names."""
    import fmpy

    shutil.copytree(folder, target, ignore=shutil.ignore_patterns("binaries", "resources"))
    root = ElementTree.parse(target / "modelDescription.xml").getroot()
    standard = int(root.attrib["fmiVersion"][0])
    identifier = root.find("CoSimulation").attrib["modelIdentifier"]  # type: ignore[union-attr]
    sources, folders, given = listed_sources(target, root, standard)
    headers = target / "standard"  # searched last: the FMU's own go first
    binaries = target / "binaries" / (fmpy.platform if standard == 2 else fmpy.platform_tuple)
    for place in (headers, binaries):
        place.mkdir(parents=True)
    for name, text in fmi_headers(standard).items():
        (headers / name).write_text(text)
    names = fmi_functions(standard)
    rest = headers / "rest.c"  # FMPy looks up functions that it does not call and that FMUs may lack
    rest.write_text("".join(f"__attribute__((weak)) int {name}(void) {{ return 3; }}\n" for name in names))
    options = ["-std=c11", "-w", "-shared", "-fPIC", "-D_DEFAULT_SOURCE", "-DNO_FUNCTION_PREFIX"]
    options += ["-DFMI_COSIMULATION", *given]
    options += [f"-D{identifier}_{name}={name}" for name in names]
    options += [f"-I{place}" for place in [*folders, headers]]
    run(["gcc", *COMMON, *options, *map(str, [*sources, rest]), "-lm", "-o", str(binaries / f"{identifier}.so")])
    return target


@dataclass(frozen=True)
class Variable:
    """A port of an FMU, with the types that FMPy's functions have in their names, and the items of an enumeration."""

    name: str
    reference: int
    type: str
    count: int
    items: tuple[int, ...]

    @property
    def is_whole(self) -> bool:
        return "Int" in self.type

    def values(self, numbers: Sequence[float]) -> list[Any]:
        """The numbers as FMPy's functions need them."""
        if self.type == "Boolean":
            return [number != 0.0 for number in numbers]
        return [math.floor(number + 0.5) for number in numbers] if self.is_whole else list(numbers)


def ports(fmpy: Any, folder: Path) -> tuple[list[Variable], list[Variable], Any]:
    """The inputs and outputs that EPG has as ports, and FMPy's description."""
    description = fmpy.read_model_description(str(folder), validate=False)
    whole = "Int64" if description.fmiVersion.startswith("3") else "Integer"
    found: dict[str, list[Variable]] = {"input": [], "output": []}
    references: set[int] = set()
    for v in description.modelVariables:
        if whole == "Int64" and v.valueReference in references:
            continue  # an alias, of which FMPy makes a variable
        references.add(v.valueReference)
        if v.causality in found and v.type not in ("String", "Binary", "Clock"):
            kind = whole if v.type == "Enumeration" else v.type
            items = tuple(int(item.value) for item in v.declaredType.items) if v.type == "Enumeration" else ()
            count = math.prod(v.shape or ())
            found[v.causality].append(Variable(v.name, v.valueReference, kind, count, items))
    return found["input"], found["output"], description


def signal(variables: Sequence[Variable]) -> list[list[float]]:
    """The inputs of each step: the same in FMPy and in the library.  Each is a value that its variable can have."""
    numbers = random.Random(7)

    def value(variable: Variable) -> float:
        if variable.items:
            return float(numbers.choice(variable.items))
        if variable.is_whole:
            return numbers.randrange(1000) / 10.0
        if variable.type == "Boolean":
            return numbers.choice((0.0, 1.0, 0.25, -1.0))
        return numbers.uniform(-1.0, 1.0) * 10.0 ** numbers.randrange(3)

    return [[value(variable) for variable in variables for _ in range(variable.count)] for _ in range(STEPS)]


def by_epg(folder: Path, work: Path, inputs: list[list[float]]) -> list[list[float]] | None:
    """The outputs at the start and after each step until the FMU ends, if it does; None for one that EPG refuses."""
    model, _ = load(folder)
    if model is None:
        return None
    library = build(model, "pan", work)
    rows = ",\n".join("{" + ", ".join([*(value.hex() for value in row), "0.0"]) + "}" for row in inputs)
    take = " ".join(f"in.{port.identifier} = rows[k][{at}];" for at, port in enumerate(model.inputs))
    show = " ".join(f'printf("%a ", out.{port.identifier});' for port in model.outputs)
    text = f"""#include "pan.h"
#include <stdio.h>
static const double rows[{STEPS}][{len(model.inputs) + 1}] = {{
{rows}
}};
int main(void)
{{
    static pan_inputs_t in;
    pan_outputs_t out;
    for (int k = 0; k < {STEPS}; k++) {{
        {take}
        if (k == 0) {{ pan_init(pan_instance(0), &in, &out); {show} puts(""); }}
        pan_step(pan_instance(0), &in, &out);
        {show} puts("");
        if (!pan_finite(pan_instance(0)) || pan_stopped(pan_instance(0))) {{ break; }}
    }}
    return 0;
}}
"""
    output = run_program(work / "run", text, [library])
    return [[float.fromhex(word) for word in line.split()] for line in output.splitlines()]


def instance(fmpy: Any, folder: Path, description: Any) -> Any:
    """FMPy's object for one FMU, in its initialization mode."""
    of_20sim = (description.generationTool or "").startswith("20-sim")
    arguments = {
        "guid": description.guid,
        "unzipDirectory": str(folder),
        "modelIdentifier": description.coSimulation.modelIdentifier,
        "instanceName": "one",
    }
    if description.fmiVersion.startswith("3"):
        fmu = fmpy.fmi3.FMU3Slave(**arguments)
        fmu.instantiate()
        fmu.enterInitializationMode(startTime=0.0)
        return fmu
    fmu = fmpy.fmi2.FMU2Slave(**arguments)
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0, stopTime=1.0e9 if of_20sim else None)
    fmu.enterInitializationMode()
    return fmu


def by_calls(
    fmpy: Any, folder: Path, step: float, inputs: list[list[float]], summed: bool = False
) -> list[list[float]]:
    """FMPy's object for one FMU, called step by step at multiples of the step, or at the sum of the steps.

    The rows end when the FMU does.
    """
    taken, given, description = ports(fmpy, folder)
    fmu = instance(fmpy, folder, description)

    def put(row: list[float]) -> None:
        at = 0
        for variable in taken:
            values = variable.values(row[at : at + variable.count])
            getattr(fmu, f"set{variable.type}")([variable.reference], values)
            at += variable.count

    def get() -> list[float]:
        size = description.fmiVersion.startswith("3")
        return [
            float(value)
            for variable in given
            for value in getattr(fmu, f"get{variable.type}")(
                [variable.reference], **({"nValues": variable.count} if size else {})
            )
        ]

    put(inputs[0])
    fmu.exitInitializationMode()
    rows, time = [get()], 0.0
    ended = False
    for number, row in enumerate(inputs):
        put(row)
        try:
            result = fmu.doStep(time if summed else number * step, step)
            ended = result is not None and result[1]  # of FMI 3.0: terminateSimulation
        except fmpy.fmi1.FMICallException as refused:
            if refused.status != DISCARD:
                raise
            ended = True
        time += step
        rows.append(get())
        if ended:
            break
    fmu.terminate()
    fmu.freeInstance()
    return rows


def by_simulation(fmpy: Any, folder: Path, step: float, inputs: list[list[float]]) -> list[list[float]]:
    """FMPy's own loop, which computes time as a multiple of the step."""
    import numpy

    taken, given, _ = ports(fmpy, folder)
    assert {variable.type for variable in [*taken, *given]} == {"Real"}
    times = numpy.arange(STEPS + 1) * step
    table = numpy.zeros(STEPS + 1, dtype=[("time", float), *((variable.name, float) for variable in taken)])
    table["time"] = times
    for at, variable in enumerate(taken):
        table[variable.name] = [row[at] for row in [*inputs, inputs[-1]]]
    result = fmpy.simulate_fmu(
        str(folder),
        start_time=0.0,
        stop_time=times[-1],
        output_interval=step,
        input=table if taken else None,
        output=[variable.name for variable in given],
        set_stop_time=False,
        validate=False,  # 20-sim's descriptions omit parts that a validator requires
    )
    return [[float(row[variable.name]) for variable in given] for row in result]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("form", FORMS)
def test_every_method_in_every_form(fmpy: Any, form: str, method: str, tmp_path: Path) -> None:
    """Methods of 20-sim sum their steps, so the library does this, too."""
    for step in ("0.001", EXACT):
        work = tmp_path / step
        folder = Export(method=method, step=step, finish="1000.0").write_whole_fmu(work / "fmu", form)
        library = compiled(folder, work / "compiled")
        inputs = signal(ports(fmpy, folder)[0])
        found = by_epg(folder, work, inputs)
        assert found is not None and len({tuple(row) for row in found}) > STEPS / 2
        assert found == by_calls(fmpy, library, float(step), inputs, summed=True)
        if step == EXACT:
            assert found == by_simulation(fmpy, library, float(step), inputs)


@pytest.mark.parametrize(("folder", "step"), [(FMU2, 0.001), (FMU3, 0.002)], ids=["fmi2", "fmi3"])
def test_fmus_of_other_tools(fmpy: Any, folder: Path, step: float, tmp_path: Path) -> None:
    """Each step has the same size, and begins at a multiple of it.  Truth values are all numbers but 0."""
    inputs = signal(ports(fmpy, folder)[0])
    found = by_epg(folder, tmp_path, inputs)
    assert found is not None and len({tuple(row) for row in found}) > STEPS / 2
    assert found == by_calls(fmpy, compiled(folder, tmp_path / "compiled"), step, inputs)


def real_fmus() -> list[Path]:
    root = os.environ.get("EPG_TEST_EXPORTS")
    described = sorted(Path(root).rglob("modelDescription.xml")) if root else []
    return [path.parent for path in described if is_fmu_folder(path.parent) and (path.parent / "sources").is_dir()]


PATHS = real_fmus()


@pytest.mark.skipif(not PATHS, reason="set EPG_TEST_EXPORTS to a folder with real exports of 20-sim")
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=lambda path: f"{path.parent.name}/{path.name}")
def test_real_fmus(fmpy: Any, path: Path, tmp_path: Path) -> None:
    model, _ = load(path)
    if model is None or not isinstance(model.code, FmuExport):
        return
    inputs = signal(ports(fmpy, path)[0])
    found = by_epg(path, tmp_path, inputs)
    assert found is not None
    own_step = model.code.own_step
    expected = by_calls(
        fmpy, compiled(path, tmp_path / "compiled"), float(model.step), inputs, summed=own_step is not None
    )
    assert own_step in (None, model.step)
    # the inputs are not those of the FMU's robot: its numbers can become infinite, and EPG's library then stops
    rest = [value for row in expected[len(found) :] for value in row]
    assert len(found) > 3 and not (rest and all(map(math.isfinite, rest)))
    assert [list(map(float.hex, row)) for row in found] == [list(map(float.hex, row)) for row in expected[: len(found)]]
