# SPDX-License-Identifier: Apache-2.0
"""FMUs of 20-sim give the same results in EPG's library as in FMPy, an ordinary importer.

This is a test of ``check_long``, because FMPy needs numpy, lxml, CMake and more, some 200 MB.
"""

from __future__ import annotations

import math
import os
import random
import shutil
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import pytest

from epg.emit.model.fmi_headers import fmi_functions, fmi_headers
from epg.models.fmu_files import is_fmu_folder
from tests.models.exports import Export
from tests.models.harness import COMMON, build, load, run, run_program

STEPS = 1000
NEEDED = "FMPy is not installed: pip install -r epg/lock/fmpy.txt"
EXACT = "0.0009765625"  # a power of two: its sums are exact
FORMS = ("globals", "instance", "output time")
METHODS = ("Discrete", "Euler", "RungeKutta2", "RungeKutta4")


@pytest.fixture(scope="module")
def fmpy() -> Any:
    return pytest.importorskip("fmpy", reason=NEEDED)


def compiled(folder: Path, target: Path) -> Path:
    """A copy of an FMU with a shared library, compiled as its own makefile would do it."""
    shutil.copytree(folder, target, ignore=shutil.ignore_patterns("binaries", "resources"))
    root = ElementTree.parse(target / "modelDescription.xml").getroot()
    identifier = root.find("CoSimulation").attrib["modelIdentifier"]  # type: ignore[union-attr]
    sources = target / "sources"
    listed = [sources / file.attrib["name"] for file in root.iter("File")] or sorted(sources.glob("*.c"))
    headers = target / "standard"  # searched last: the FMU's own go first
    binaries = target / "binaries" / "linux64"
    for place in (headers, binaries):
        place.mkdir(parents=True)
    for name, text in fmi_headers(2).items():
        (headers / name).write_text(text)
    rest = headers / "rest.c"  # FMPy looks up functions that it does not call and that FMUs may lack
    rest.write_text("".join(f"__attribute__((weak)) int {name}(void) {{ return 3; }}\n" for name in fmi_functions(2)))
    options = ["-std=c11", "-w", "-shared", "-fPIC", "-DNO_FUNCTION_PREFIX", f"-I{sources}", f"-I{headers}"]
    run(["gcc", *COMMON, *options, *map(str, [*listed, rest]), "-lm", "-o", str(binaries / f"{identifier}.so")])
    return target


def signal(count: int) -> list[list[float]]:
    """The inputs of each step: the same in FMPy and in the library."""
    numbers = random.Random(7)
    return [[numbers.uniform(-1.0, 1.0) * 10.0 ** numbers.randrange(3) for _ in range(count)] for _ in range(STEPS)]


def by_epg(folder: Path, work: Path, inputs: list[list[float]]) -> list[list[float]] | None:
    """The outputs at the start and after each step; None for an FMU that EPG refuses."""
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
    }}
    return !pan_finite(pan_instance(0));
}}
"""
    output = run_program(work / "run", text, [library])
    return [[float.fromhex(word) for word in line.split()] for line in output.splitlines()]


def ports(fmpy: Any, folder: Path) -> tuple[list[Any], list[Any], Any]:
    description = fmpy.read_model_description(str(folder))
    found = [[v for v in description.modelVariables if v.causality == kind] for kind in ("input", "output")]
    return found[0], found[1], description


def by_calls(fmpy: Any, folder: Path, step: float, inputs: list[list[float]]) -> list[list[float]]:
    """FMPy's object for one FMU, called step by step at the sum of the steps."""
    from fmpy.fmi2 import FMU2Slave

    taken, given, description = ports(fmpy, folder)
    fmu = FMU2Slave(
        guid=description.guid,
        unzipDirectory=str(folder),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="one",
    )
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0, stopTime=1.0e9)
    fmu.enterInitializationMode()
    references = [[variable.valueReference for variable in group] for group in (taken, given)]
    if taken:
        fmu.setReal(references[0], inputs[0])
    fmu.exitInitializationMode()
    rows, time = [fmu.getReal(references[1])], 0.0
    for row in inputs:
        if taken:
            fmu.setReal(references[0], row)
        fmu.doStep(currentCommunicationPoint=time, communicationStepSize=step)
        time += step
        rows.append(fmu.getReal(references[1]))
    fmu.terminate()
    fmu.freeInstance()
    return rows


def by_simulation(fmpy: Any, folder: Path, step: float, inputs: list[list[float]]) -> list[list[float]]:
    """FMPy's own loop, which computes time as a multiple of the step."""
    import numpy

    taken, given, _ = ports(fmpy, folder)
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
    inputs = signal(2)
    for step in ("0.001", EXACT):
        work = tmp_path / step
        folder = Export(method=method, step=step, finish="1000.0").write_whole_fmu(work / "fmu", form)
        library = compiled(folder, work / "compiled")
        found = by_epg(folder, work, inputs)
        assert found is not None and len({tuple(row) for row in found}) > STEPS / 2
        assert found == by_calls(fmpy, library, float(step), inputs)
        if step == EXACT:
            assert found == by_simulation(fmpy, library, float(step), inputs)


def real_fmus() -> list[Path]:
    root = os.environ.get("EPG_TEST_EXPORTS")
    described = sorted(Path(root).rglob("modelDescription.xml")) if root else []
    folders = [path.parent for path in described if is_fmu_folder(path.parent)]
    return [
        folder
        for folder in folders
        if 'generationTool="20-sim' in (folder / "modelDescription.xml").read_text("latin-1")
        and (folder / "sources" / "xxinteg.c").is_file()
    ]


PATHS = real_fmus()


@pytest.mark.skipif(not PATHS, reason="set EPG_TEST_EXPORTS to a folder with real exports of 20-sim")
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=lambda path: f"{path.parent.name}/{path.name}")
def test_real_fmus(fmpy: Any, path: Path, tmp_path: Path) -> None:
    taken, _, description = ports(fmpy, path)
    inputs = signal(len(taken))
    found = by_epg(path, tmp_path, inputs)
    if found is None:
        return
    step = float(description.defaultExperiment.stepSize)
    library = compiled(path, tmp_path / "compiled")
    expected = by_calls(fmpy, library, step, inputs)
    assert [list(map(float.hex, row)) for row in found] == [list(map(float.hex, row)) for row in expected]
    if "outputTime" in (path / "sources" / "xxinteg.c").read_text("latin-1"):
        for row, other in zip(found, by_simulation(fmpy, library, step, inputs), strict=True):
            pairs = zip(row, other, strict=True)
            assert all(math.isclose(a, b, rel_tol=1e-6, abs_tol=1e-9) or not abs(a) < 1e12 for a, b in pairs)
