# SPDX-License-Identifier: Apache-2.0
"""Real FMUs give the same bits in EPG's library as with their own functions, and fit microcontrollers.

They are not part of EPG: the environment variable EPG_TEST_EXPORTS names a folder with unpacked FMUs anywhere below it.
Their functions may have no prefix, because the importer sets it, or one that can be omitted.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from epg.generator.emit.model import emit_model, model_build
from epg.generator.importers import Model
from epg.generator.importers.fmu.fmu_files import is_fmu_folder
from tests.models.direct import run_fmu
from tests.models.fmus import pack, run_any
from tests.models.harness import build, load, loaded, run_program, run_wrapper

STEPS = 1000
SKIPPED = "set EPG_TEST_EXPORTS to a folder with real exports of 20-sim"
REFUSED = {
    "fmu-language",  # C++
    "fmu-file-missing",  # sources without a header, or no source in C
    "fmu-no-sources",
    "fmu-interface",
    "model-file-use",
    "model-heap",
    "fmu-variable",
    "fmu-guid",
    "model-stub",
    "fmu-not-compiled",
    "model-incomplete",
}


def fmu_paths() -> list[Path]:
    root = os.environ.get("EPG_TEST_EXPORTS")
    found = sorted(Path(root).rglob("modelDescription.xml")) if root else []
    return [path.parent for path in found if is_fmu_folder(path.parent) and (path.parent / "sources").is_dir()]


PATHS = fmu_paths()
needs_fmus = pytest.mark.skipif(not PATHS, reason=SKIPPED)


def readable(path: Path) -> str:
    return path.relative_to(os.environ["EPG_TEST_EXPORTS"]).as_posix() if PATHS else "none"


def usable(path: Path, folder: Path) -> Model | None:
    """The model, with a step of 10 ms if the FMU has none; None if EPG refuses it."""
    model, diagnostics = load(path)
    if model is None and any(item.id == "fmu-step" for item in diagnostics):
        folder.mkdir(exist_ok=True)
        text = f"version: 1\nfmu: {path}\nstep: 10 ms\ndefinitions: {{FMI_COSIMULATION: 1}}\n"  # the latter: FMU SDK
        (folder / "model.yaml").write_text(text)
        model, diagnostics = load(folder)
    if model is None:
        assert {item.id for item in diagnostics if item.severity == "error"} <= REFUSED
    return model


@needs_fmus
@pytest.mark.parametrize("path", PATHS or [Path("none")], ids=readable)
def test_same_numbers(path: Path, tmp_path: Path) -> None:
    """From the folder, and packed as an archive."""
    model = usable(path, tmp_path / "own")
    if model is None:
        return
    names = [port.name for port in model.inputs], [port.name for port in model.outputs]
    description = ElementTree.parse(path / "modelDescription.xml").getroot()
    of_20sim = description.attrib.get("generationTool", "").startswith("20-sim")
    if of_20sim:
        expected = run_fmu(path / "sources", tmp_path / "direct", *names, STEPS)
    else:
        expected = run_any(path, tmp_path / "direct", float(model.step), STEPS)
    assert run_wrapper(build(model, "model", tmp_path), STEPS, of_20sim) == expected
    if model.directory == path:
        packed = loaded(pack(path, tmp_path / "packed.fmu"))
        assert run_wrapper(build(packed, "packed", tmp_path), STEPS, of_20sim) == expected


@needs_fmus
def test_all_of_them_in_one_program(tmp_path: Path) -> None:
    """Each has as many instances as it allows; they do not affect each other."""
    libraries = []
    for index, path in enumerate(PATHS):
        model = usable(path, tmp_path / f"own{index}")
        if model is not None:
            libraries.append(build(model, f"fmu{index}", tmp_path, instances=2 if model.instantiable else 1))
    assert len(libraries) >= 2
    parts, calls = [], []
    for library in libraries:
        name, model = library.name, library.model
        take = " ".join(f"in[i].{port.identifier} = 0.01 * (k % 17) + i;" for port in model.inputs)
        show = " ".join(f'printf("%a ", out[0].{port.identifier});' for port in model.outputs)
        parts.append(f"""
static void {name}_run(int first, int last, unsigned instances)
{{
    static {name}_inputs_t in[2];
    static {name}_outputs_t out[2];
    for (int k = first; k < last; k++) {{
        for (unsigned i = 0; i < instances && i < {name.upper()}_INSTANCES; i++) {{
            {take}
            if (k == 0) {{ {name}_init({name}_instance(i), &in[i], &out[i]); }}
            {name}_step({name}_instance(i), &in[i], &out[i]);
        }}
    }}
    if (last == 60) {{ {show} puts(""); }}
}}
""")
        calls.append(name)
    includes = "".join(f'#include "{name}.h"\n' for name in calls) + "#include <stdio.h>\n"
    first = " ".join(f"{name}_run(0, 30, 2);" for name in calls)
    second = " ".join(f"{name}_run(30, 60, 2);" for name in calls)
    text = f"{includes}{''.join(parts)}int main(void) {{ {first} {second} return 0; }}\n"
    together = run_program(tmp_path / "all", text, libraries).splitlines()
    for library, part, line in zip(libraries, parts, together, strict=True):
        alone = f'#include "{library.name}.h"\n#include <stdio.h>\n{part}'
        alone += f"int main(void) {{ {library.name}_run(0, 60, 1); return 0; }}\n"
        assert run_program(tmp_path / library.name / "alone", alone, [library]).strip() == line.strip()


@needs_fmus
@pytest.mark.parametrize("cpu", ["cortex-m0plus", "cortex-m33"])
def test_links_for_microcontrollers(cpu: str, tmp_path: Path) -> None:
    """Each alone, with only the library's own memory."""
    compiler = shutil.which("arm-none-eabi-gcc")
    if compiler is None:
        pytest.skip("arm-none-eabi-gcc is not installed: sudo apt install gcc-arm-none-eabi libnewlib-arm-none-eabi")
    count = 0
    for index, path in enumerate(PATHS):
        model = usable(path, tmp_path / f"own{index}")
        if model is None:
            continue
        folder = tmp_path / str(index)
        for file, text in emit_model(model, "fmu").items():
            (folder / file).parent.mkdir(parents=True, exist_ok=True)
            (folder / file).write_text(text)
        made = model_build(model, "fmu")
        (folder / "main.c").write_text("""
#include "fmu.h"
int main(void)
{
    static fmu_inputs_t in;
    static fmu_outputs_t out;
    fmu_init(fmu_instance(0), &in, &out);
    fmu_step(fmu_instance(0), &in, &out);
    return !fmu_finite(fmu_instance(0));
}
""")
        flags = [f"-mcpu={cpu}", "-mthumb", "-Os", "-std=c11", "-ffunction-sections", "-fdata-sections", f"-I{folder}"]
        own = ["-w", "-include", str(folder / "fmu_names.h"), *(f"-I{place}" for place in made.include_dirs)]
        own += [f"-I{folder}/fmu_headers"]
        objects = []
        for source in [folder / "main.c", folder / "fmu.c", folder / "fmu_export.c", *made.exported]:
            objects.append(str(folder / f"{len(objects)}.o"))
            options = own if len(objects) > 2 else ["-Wall", "-Wextra", "-Wconversion", "-Wdouble-promotion", "-Werror"]
            subprocess.run([compiler, *flags, *options, "-c", str(source), "-o", objects[-1]], check=True)
        linking = ["--specs=nosys.specs", "-Wl,--gc-sections,--no-warn-rwx-segments", "-lm"]
        image = folder / "image.elf"
        subprocess.run([compiler, *flags, *objects, *linking, "-o", str(image)], check=True, stderr=subprocess.DEVNULL)
        symbols = subprocess.run(["arm-none-eabi-nm", str(image)], check=True, capture_output=True, text=True).stdout
        assert "fmu_private_" in symbols
        count += 1
    assert count >= 2
