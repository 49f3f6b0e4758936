# SPDX-License-Identifier: Apache-2.0
"""FMUs: the data that EPG reads from folders and archives, and the messages for FMUs that it cannot use."""

from __future__ import annotations

import io
import struct
import time
import tracemalloc
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from random import Random

import pytest
import yaml

from epg.models.details import FmuExport
from tests.models.exports import Export
from tests.models.fmus import FMU2, FMU3, changed, pack
from tests.models.harness import HAVE_COMPILER, build, load, loaded, run_wrapper


def only_error(path: Path) -> tuple[str, str]:
    model, diagnostics = load(path)
    assert model is None
    errors = [item for item in diagnostics if item.severity == "error"]
    assert len(errors) == 1, [item.message for item in errors]
    assert errors[0].hint or errors[0].id in ("wrong-type", "wrong-value")
    return errors[0].id, errors[0].message


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_reads_everything(archive: bool, tmp_path: Path) -> None:
    model = loaded(pack(FMU2, tmp_path / "servo.fmu") if archive else FMU2)
    assert (model.name, model.origin, model.language) == ('Servo "1"', "FMI 2.0 FMU", "c")
    assert model.step == Fraction(1, 1000) and model.instantiable
    assert [(p.name, p.identifier, p.unit, p.type, p.index) for p in model.inputs] == [
        ("plant.setpoint", "plant_setpoint", "rad", "real", 0),  # the unit of its declared type
        ("plant.position", "plant_position", "rad", "real", 1),
        ("enable", "enable", "", "boolean", 2),
        ("mode", "mode", "", "integer", 3),
    ]
    assert model.inputs[1].description == "measured"
    assert [(p.name, p.unit, p.type) for p in model.outputs] == [
        ("duty", "", "real"),
        ("steps", "", "integer"),
        ("saturated", "", "boolean"),
    ]
    assert [(p.name, p.identifier, p.value, p.unit) for p in model.parameters] == [
        ("PI.kp", "PI_kp", 2.0, ""),
        ("PI.ki", "PI_ki", 0.5, "1/s"),
        ("table size", "table_size", 4.0, ""),
    ]
    assert [p.tunable for p in model.parameters] == [True, True, False]
    line = model.inputs[0].span.line
    assert 'name="plant.setpoint"' in (FMU2 / "modelDescription.xml").read_text().splitlines()[line - 1]
    names = {path.name for path in model.files}
    assert names == ({"servo.fmu"} if archive else {"modelDescription.xml", "servo.c", "law.c", "law.h"})


def test_reads_fmi_3(tmp_path: Path) -> None:
    model = loaded(FMU3)
    assert (model.name, model.origin, model.step) == ("Axes", "FMI 3.0 FMU", Fraction(1, 500))
    assert [(p.name, p.identifier, p.unit, p.type) for p in model.inputs] == [
        ("setpoint[1]", "setpoint_1", "rad", "real"),
        ("setpoint[2]", "setpoint_2", "rad", "real"),
        ("setpoint[3]", "setpoint_3", "rad", "real"),
        ("gain", "gain", "", "real"),
        ("mask", "mask", "", "integer"),
        ("hold", "hold", "", "boolean"),
    ]
    assert [(p.name, p.value) for p in model.parameters] == [("slope", 0.25), ("offset", -1.0)]
    assert {path.name for path in model.files} == {"modelDescription.xml", "all.c", "axes.c", "axes.h"}


def test_where_an_fmu_is_found(tmp_path: Path) -> None:
    folder = tmp_path / "model"
    pack(FMU2, folder / "servo.fmu")
    assert loaded(folder).origin == loaded(folder / "servo.fmu").origin == "FMI 2.0 FMU"
    assert loaded(FMU2 / "modelDescription.xml").origin == "FMI 2.0 FMU"
    pack(FMU3, folder / "axes.fmu")
    id, message = only_error(folder)
    assert id == "model-ambiguous" and "2 models" in message
    assert only_error(FMU2 / "sources/servo.c")[0] == "model-not-recognised"


def test_a_matrix_has_its_elements_as_ports(tmp_path: Path) -> None:
    folder = changed(
        FMU3,
        tmp_path / "fmu",
        "modelDescription.xml",
        (
            'causality="output"><Dimension start="3"/>',
            'causality="output"><Dimension start="2"/><Dimension start="3"/>',
        ),
    )
    names = [port.name for port in loaded(folder).outputs]
    assert names[:6] == ["duty[1,1]", "duty[1,2]", "duty[1,3]", "duty[2,1]", "duty[2,2]", "duty[2,3]"]


def test_parameters_that_can_be_tuned_come_first(tmp_path: Path) -> None:
    fixed = ('variability="tunable"><Real start="2.0"/>', 'variability="fixed"><Real start="2.0"/>')
    model = loaded(changed(FMU2, tmp_path / "fmu", "modelDescription.xml", fixed))
    assert [(p.name, p.index, p.tunable) for p in model.parameters] == [
        ("PI.ki", 0, True),
        ("PI.kp", 1, False),
        ("table size", 2, False),
    ]
    assert [place.reference for place in model.details.parameters] == [4, 3, 2]  # type: ignore[union-attr]


def test_one_instance_only(tmp_path: Path) -> None:
    flag = 'canBeInstantiatedOnlyOncePerProcess="true"'
    change = ('canHandleVariableCommunicationStepSize="true"', flag)
    assert not loaded(changed(FMU2, tmp_path / "fmu", "modelDescription.xml", change)).instantiable


@pytest.mark.parametrize(
    ("text", "id"),
    [
        ('void *p = fopen(self->name, "r");', "model-file-use"),
        ("self->law.errors = malloc(8);", "model-heap"),
        ("self->law.errors = self->functions->allocateMemory(1, 8);", "model-heap"),
    ],
)
def test_what_cannot_run_in_a_step(text: str, id: str, tmp_path: Path) -> None:
    change = ("    double error =", f"    {text}\n    double error =")
    path = changed(FMU2, tmp_path / "fmu", "sources/servo.c", change)
    found, _ = only_error(path)
    assert found == id
    _, diagnostics = load(pack(path, tmp_path / "a.fmu"))
    assert diagnostics.items[0].span.text is not None and text[:8] in diagnostics.items[0].span.text


def test_files_when_it_starts(tmp_path: Path) -> None:
    change = ("    self->functions = functions;", '    self->functions = functions; fopen("x", "r");')
    assert only_error(changed(FMU2, tmp_path / "fmu", "sources/servo.c", change))[0] == "model-file-use"


def test_sources_that_nobody_lists(tmp_path: Path) -> None:
    """For FMUs of older tools, every C file is a source."""
    folder = tmp_path / "fmu"
    text = (FMU2 / "modelDescription.xml").read_text()
    start, end = text.index("<SourceFiles>"), text.index("</SourceFiles>") + len("</SourceFiles>")
    changed(FMU2, folder, "modelDescription.xml", (text[start:end], ""))
    (folder / "sources/notes.txt").write_text("no source")
    assert {path.name for path in loaded(folder).files} == {"modelDescription.xml", "servo.c", "law.c", "law.h"}


@pytest.mark.parametrize("archive", [False, True], ids=["folder", "archive"])
def test_headers_in_folders_that_nothing_names(archive: bool, tmp_path: Path) -> None:
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", ""))
    (folder / "sources" / "lib" / "control").mkdir(parents=True)
    (folder / "sources" / "law.h").rename(folder / "sources" / "lib" / "control" / "law.h")
    model, diagnostics = load(pack(folder, tmp_path / "a.fmu") if archive else folder)
    assert model is not None and isinstance(model.details, FmuExport)
    assert [(item.severity, item.id) for item in diagnostics] == [("note", "model-neighbour")]
    assert (
        "these headers are in 'sources/lib/control'" in diagnostics.items[0].message
        and "law.h" in diagnostics.items[0].message
    )
    if HAVE_COMPILER:
        run_wrapper(build(model, "servo", tmp_path / "build"), 3)


def test_headers_of_one_name_in_several_folders(tmp_path: Path) -> None:
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", ("", ""))
    for name in ("old", "new"):
        (folder / "sources" / name).mkdir()
        (folder / "sources" / name / "law.h").write_text((folder / "sources" / "law.h").read_text() + f"int {name};\n")
    (folder / "sources" / "law.h").unlink()
    id, message = only_error(folder)
    assert id == "fmu-file-missing" and "'law.h' is in 2 folders of the FMU" in message


def test_memory_that_steps_keep_is_one_error(tmp_path: Path) -> None:
    taking = "static void *one(void) { return malloc(1); }\nstatic void *two(void) { return malloc(2); }\n"
    text = ("    double error =", "    one(); two();\n    double error =")
    folder = changed(FMU2, tmp_path / "fmu", "sources/servo.c", text)
    source = folder / "sources" / "servo.c"
    source.write_text(source.read_text().replace("fmi2Status fmi2DoStep", f"{taking}fmi2Status fmi2DoStep", 1))
    id, message = only_error(folder)
    assert id == "model-heap" and "'one'" in message and "(also two)" in message


def test_headers_of_other_systems_may_be_missing(tmp_path: Path) -> None:
    other = '#ifdef _WIN32\n#include "windows_only.h"\n#endif\n#include "law.h"'
    loaded(changed(FMU2, tmp_path / "fmu", "sources/servo.c", ('#include "law.h"', other)))


# model.yaml ----------------------------------------------------------------------------------------------------------


def settings(folder: Path, **document: object) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "model.yaml").write_text(yaml.safe_dump({"version": 1, **document}))
    return folder


def test_model_yaml_says_what_the_fmu_does_not(tmp_path: Path) -> None:
    pack(FMU2, tmp_path / "model/servo.fmu")
    folder = settings(tmp_path / "model", fmu="servo.fmu", step="2 ms", heap="2 KiB", definitions={"A": 1, "B": None})
    model = loaded(folder)
    assert model.step == Fraction(1, 500) and model.details.heap == 2048  # type: ignore[union-attr]
    assert model.details.definitions == (("A", "1"), ("B", ""))  # type: ignore[union-attr]
    assert {path.name for path in model.files} == {"model.yaml", "servo.fmu"}
    assert model.directory == folder
    settings(tmp_path / "model", fmu=".")
    assert only_error(folder)[0] == "file-not-found"


WRONG = [
    ({"fmu": "a.fmu"}, "file-not-found"),
    ({"fmu": ""}, "wrong-value"),
    ({"fmu": ["servo.fmu"]}, "wrong-type"),
    ({"heap": 2048}, "wrong-type"),
    ({"heap": "2 kB"}, "wrong-value"),
    ({"heap": "1 B"}, "out-of-range"),
    ({"heap": "65 MiB"}, "out-of-range"),
    ({"step": "1"}, "wrong-unit"),
    ({"definitions": ["A"]}, "wrong-type"),
    ({"definitions": {"A B": 1}}, "invalid-name"),
    ({"definitions": {"A": [1]}}, "wrong-type"),
    ({"definitions": {"A": "1/* x"}}, "wrong-value"),
    ({"step": "0 s"}, "out-of-range"),
    ({"sources": ["a.c"]}, "unknown-key"),
    ({"version": 2}, "newer-version"),
]


@pytest.mark.parametrize(("change", "id"), WRONG, ids=[f"{next(iter(c))}-{n}" for n, (c, _) in enumerate(WRONG)])
def test_wrong_model_yaml(change: dict[str, object], id: str, tmp_path: Path) -> None:
    pack(FMU2, tmp_path / "model/servo.fmu")
    document = {"fmu": "servo.fmu", **change}
    assert only_error(settings(tmp_path / "model", **document))[0] == id


def test_the_step_must_suit_20sim(tmp_path: Path) -> None:
    """20-sim's FMUs take whole steps of their own length."""
    folder = changed(
        FMU2, tmp_path / "fmu", "modelDescription.xml", ('generationTool="tests"', 'generationTool="20-sim"')
    )
    assert loaded(folder).details.own_step == Fraction(1, 1000)  # type: ignore[union-attr]
    model = loaded(settings(tmp_path / "model", fmu="../fmu", step="3 ms"))
    assert (model.step, model.details.own_step) == (Fraction(3, 1000), Fraction(1, 1000))  # type: ignore[union-attr]
    assert only_error(settings(tmp_path / "model", fmu="../fmu", step="1.5 ms"))[0] == "fmu-step"


def test_the_step_of_20sims_method_is_read_from_the_sources(tmp_path: Path) -> None:
    """Independent of the description, and also if it does not name 20-sim."""
    for form in ("globals", "instance", "output time"):
        folder = Export(step="0.0005").write_whole_fmu(tmp_path / form, form)
        description = folder / "modelDescription.xml"
        text = description.read_text().replace('stepSize="0.0005"', 'stepSize="0.002"')
        description.write_text(text.replace(' generationTool="20-sim"', ""))
        model = loaded(folder)
        assert isinstance(model.details, FmuExport)
        assert (model.step, model.details.own_step) == (Fraction(2, 1000), Fraction(1, 2000))
        description.write_text(text.replace("0.002", "0.0007"))
        assert only_error(folder)[0] == "fmu-step"
        description.write_text(text.replace("0.002", "50.0005"))
        assert "more than 100000 internal steps of the FMU" in only_error(folder)[1]
    assert loaded(FMU2).details.own_step is None  # type: ignore[union-attr]


def test_the_identifier_of_the_sources(tmp_path: Path) -> None:
    """Only an identifier that the code uses counts; of several for different versions of FMI, one must fit."""
    define = '#define GUID "{6f1c9a0e-servo}"'
    other = '#define GUID "{another}"'
    for name, text, id in (
        ("other", other, "fmu-guid"),
        ("alias", '#define SERVO_GUID "{another}"\n#define GUID SERVO_GUID', "fmu-guid"),
        ("two", f'#if FMI_VERSION == 1\n#define GUID "{{old}}"\n#else\n{define}\n#endif', ""),
        ("unused", f'{define}\n#define TEMPLATE_GUID "{{none}}"', ""),
    ):
        folder = changed(FMU2, tmp_path / name, "sources/servo.c", (define, text))
        assert (only_error(folder)[0] if id else loaded(folder).name) == (id or 'Servo "1"')
    folder = Export().write_whole_fmu(tmp_path / "20sim", "instance")
    loaded(folder)
    (folder / "sources" / "fmiGUID.h").write_text('#define FMI_GUID "{of another export}"\n')
    packed = pack(folder, tmp_path / "packed.fmu")
    for path in (folder, packed):
        assert only_error(path)[0] == "fmu-guid"


# hostile archives ----------------------------------------------------------------------------------------------------

DESCRIPTION = (FMU2 / "modelDescription.xml").read_bytes()


def archive(*entries: tuple[str | zipfile.ZipInfo, bytes]) -> bytes:
    data = io.BytesIO()
    with zipfile.ZipFile(data, "w", zipfile.ZIP_DEFLATED) as packed:
        for entry, content in entries:
            packed.writestr(entry, content)
    return data.getvalue()


def with_source(name: str | zipfile.ZipInfo, content: bytes = b"int x;") -> bytes:
    sources = [(f"sources/{path.name}", path.read_bytes()) for path in sorted((FMU2 / "sources").iterdir())]
    return archive(("modelDescription.xml", DESCRIPTION), *sources, (name, content))


def link_to(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name)
    entry.create_system = 3
    entry.external_attr = 0o120777 << 16
    return entry


def edited(data: bytes, old: bytes, new: bytes) -> bytes:
    assert len(old) == len(new) and old in data
    return data.replace(old, new)


def encrypted(data: bytes) -> bytes:
    """The flag for encryption is set in every entry of the list of files."""
    at = data.find(b"PK\1\2")
    while at >= 0:
        data = data[: at + 8] + struct.pack("<H", struct.unpack_from("<H", data, at + 8)[0] | 1) + data[at + 10 :]
        at = data.find(b"PK\1\2", at + 4)
    return data


def bomb() -> bytes:
    return archive(
        ("modelDescription.xml", DESCRIPTION), *((f"sources/{n}.c", bytes(1) * (15 << 20)) for n in range(20))
    )


def lying_bomb() -> bytes:
    """The list of files claims that 40 MiB are 6 bytes."""
    data = archive(("modelDescription.xml", DESCRIPTION), ("sources/a.c", b"\n" * (40 << 20)))
    return data.replace(struct.pack("<L", 40 << 20), struct.pack("<L", 6))


def entity_bomb() -> bytes:
    levels = "".join(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 9))
    text = f'<!DOCTYPE x [<!ENTITY a0 "lol">{levels}]><fmiModelDescription fmiVersion="2.0">&a8;</fmiModelDescription>'
    return archive(("modelDescription.xml", text.encode()))


def external_entity() -> bytes:
    text = (
        '<!DOCTYPE x [<!ENTITY a SYSTEM "file:///etc/passwd">]><fmiModelDescription fmiVersion="2.0" modelName="&a;"/>'
    )
    return archive(("modelDescription.xml", text.encode()))


def huge_directory() -> bytes:
    return archive(*((f"r/{n}", b"") for n in range(20_001)))


def binary_source() -> bytes:
    """A listed source that is not text."""
    sources = {path.name: path.read_bytes() for path in (FMU2 / "sources").iterdir()}
    sources["law.c"] = b"\0\1\2"
    return archive(("modelDescription.xml", DESCRIPTION), *((f"sources/{name}", d) for name, d in sources.items()))


def packed_by(method: int, data: bytes = b"int x;\n" * 999) -> bytes:
    """An FMU with one source that is packed by another method than deflate."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("sources/x.c", data, method)
    return output.getvalue()


def corrupt_lzma() -> bytes:
    data = packed_by(zipfile.ZIP_LZMA)
    at = data.find(b"sources/x.c") + len("sources/x.c")
    return data[: at + 4] + bytes(b ^ 0xFF for b in data[at + 4 : at + 30]) + data[at + 30 :]


def hidden_entries() -> bytes:
    """More entries than allowed, in an archive whose end record counts only one."""
    data = archive(*((f"r/{n}", b"") for n in range(20_001)))
    return data[:-14] + struct.pack("<2H", 1, 1) + data[-10:]


def claims_more() -> bytes:
    """The list of files claims that a stored file is 3 bytes longer than it is."""
    output = io.BytesIO()
    with zipfile.ZipFile(output, "w") as packed:
        packed.writestr("modelDescription.xml", DESCRIPTION)
        packed.writestr("sources/x.c", b"int x;\n" * 9)
    return output.getvalue().replace(struct.pack("<2L", 63, 63), struct.pack("<2L", 63, 66))


HOSTILE: dict[str, tuple[Callable[[], bytes], str]] = {
    "up": (lambda: with_source("sources/../../../evil.c"), "fmu-unreadable"),
    "up-hidden": (lambda: with_source("sources/a/../../evil.c"), "fmu-unreadable"),
    "backslash": (lambda: with_source("sources/..\\..\\evil.c"), "fmu-unreadable"),
    "drive": (lambda: with_source("sources/C:/evil.c"), "fmu-unreadable"),
    "empty-part": (lambda: with_source("sources//etc/evil.c"), "fmu-unreadable"),
    "list": (lambda: with_source("sources/a;b.c"), "fmu-unreadable"),
    "long": (lambda: with_source(f"sources/{'a' * 300}.c"), "fmu-unreadable"),
    "file-and-folder": (lambda: with_source("sources/law.h/x.h"), "fmu-unreadable"),
    "device": (lambda: with_source("sources/con.c"), "fmu-unreadable"),
    "control": (lambda: with_source("sources/a\x1b[2Jb.c"), "fmu-unreadable"),
    "nul": (lambda: edited(with_source("sources/evilXc.c"), b"evilXc", b"evil\0c"), "fmu-unreadable"),
    "trailing-dot": (lambda: with_source("sources/evil.c."), "fmu-unreadable"),
    "link": (lambda: with_source(link_to("sources/x.c"), b"/etc/passwd"), "fmu-unreadable"),
    "twice-by-case": (lambda: with_source("sources/LAW.c"), "fmu-unreadable"),
    "encrypted": (lambda: encrypted(with_source("sources/x.c")), "fmu-unreadable"),
    "bomb": (bomb, "fmu-unreadable"),
    "lying-bomb": (lying_bomb, "fmu-unreadable"),
    "entity-bomb": (entity_bomb, "model-xml"),
    "external-entity": (external_entity, "model-xml"),
    "many-files": (huge_directory, "fmu-unreadable"),
    "no-zip": (lambda: b"MZ" * 1000, "fmu-unreadable"),
    "empty": (lambda: b"", "fmu-unreadable"),
    "truncated": (lambda: with_source("sources/x.c")[:-30], "fmu-unreadable"),
    "cut-content": (
        lambda: (data := with_source("sources/x.c"))[:60] + bytes(300) + data[360:],
        "fmu-unreadable",
    ),
    "binary-source": (binary_source, "model-unreadable"),
    "no-description": (lambda: archive(("sources/a.c", b"")), "fmu-unreadable"),
    "bzip2": (lambda: packed_by(zipfile.ZIP_BZIP2), "fmu-unreadable"),
    "bzip2-bomb": (lambda: packed_by(zipfile.ZIP_BZIP2, bytes(200 << 20)), "fmu-unreadable"),
    "lzma": (lambda: packed_by(zipfile.ZIP_LZMA), "fmu-unreadable"),
    "corrupt-lzma": (corrupt_lzma, "fmu-unreadable"),
    "hidden-entries": (hidden_entries, "fmu-unreadable"),
    "claims-more": (claims_more, "fmu-unreadable"),
    "method": (lambda: edited(with_source("sources/x.c"), b"\x08\x00", b"\x63\x00"), "fmu-unreadable"),
}


@pytest.mark.parametrize("kind", sorted(HOSTILE))
def test_hostile_archives(kind: str, tmp_path: Path) -> None:
    """One error each, in little time and memory, and no file is written."""
    make, id = HOSTILE[kind]
    folder = tmp_path / "a" / "b"
    folder.mkdir(parents=True)
    path = folder / "servo.fmu"
    path.write_bytes(make())
    before = sorted(tmp_path.rglob("*"))
    tracemalloc.start()
    start = time.process_time()
    assert only_error(path)[0] == id
    assert time.process_time() - start < 10
    assert tracemalloc.get_traced_memory()[1] < 200 << 20
    tracemalloc.stop()
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize(
    ("method", "name"), [(zipfile.ZIP_BZIP2, "bzip2"), (zipfile.ZIP_LZMA, "LZMA")], ids=["bzip2", "lzma"]
)
def test_other_methods_of_compression_are_named(method: int, name: str, tmp_path: Path) -> None:
    path = tmp_path / "servo.fmu"
    path.write_bytes(packed_by(method))
    assert only_error(path)[1] == f"'sources/x.c' in the FMU is compressed with {name}, which FMUs must not use"


@pytest.mark.parametrize("folder", [FMU2, FMU3], ids=["fmi2", "fmi3"])
def test_damage_of_any_kind(folder: Path, tmp_path: Path) -> None:
    """Changed bytes, in the archive or in its files, give a model or an error, never another exception."""
    random = Random(2)
    whole = pack(folder, tmp_path / "whole.fmu").read_bytes()
    names = [path.relative_to(folder).as_posix() for path in sorted(folder.rglob("*")) if path.is_file()]
    refused = 0
    for round in range(200):
        data = bytearray(whole)
        if round % 2:
            name = random.choice(["modelDescription.xml", *(n for n in names if n.endswith((".xml", ".c", ".h")))])
            text = bytearray((folder / name).read_bytes())
            for _ in range(random.randint(1, 4)):
                at = random.randrange(len(text))
                text[at : at + random.randint(0, 9)] = random.choice(
                    [b"", b"<", b'"', b"\0", b"9999999999", b"}", b"\xff"]
                )
            entries = [(n, bytes(text) if n == name else (folder / n).read_bytes()) for n in names]
            data = bytearray(archive(*entries))
        else:
            for _ in range(random.randint(1, 8)):
                data[random.randrange(len(data))] = random.randrange(256)
        path = tmp_path / "damaged.fmu"
        path.write_bytes(data)
        model, diagnostics = load(path)
        assert (model is None) == diagnostics.has_errors
        refused += model is None
    assert 50 < refused < 200


def test_what_is_no_part_of_the_model_does_not_matter(tmp_path: Path) -> None:
    """EPG unpacks no other file, whatever its name is."""
    path = tmp_path / "servo.fmu"
    path.write_bytes(with_source("resources/../../evil?.txt"))
    loaded(path)
