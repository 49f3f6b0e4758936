# SPDX-License-Identifier: Apache-2.0
"""Reads the ``model.yaml`` of a controller written by hand: its ports, step size and functions.

``schemas/model.schema.json`` has the rules for the form of the file.  This module checks what a schema cannot check.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from epg.generator.diagnostics import Diagnostics, did_you_mean
from epg.generator.documents.schema import load_schema, validate
from epg.generator.documents.source_file import SourceFile, is_includable, read_source
from epg.generator.documents.text_file import is_file, is_folder, one_line
from epg.generator.documents.yaml_file import load_yaml, newer_version
from epg.generator.importers.by_hand.hand_written_code import BitField, HandWritten
from epg.generator.importers.by_hand.hand_written_names import Declaration, Names, integer_range, is_integer
from epg.generator.importers.by_hand.model_yaml import step_of
from epg.generator.models.c_code import CFile, parse_code
from epg.generator.models.features import rounded_in
from epg.generator.models.folders import source_files
from epg.generator.models.identifiers import is_reserved, to_identifier
from epg.generator.models.model import Model, Parameter, Port
from epg.generator.models.ports import check_identifiers
from epg.generator.source import Span, YamlNode

_MEMBER = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*|\[\d{1,9}\])*", re.ASCII)
_HEADERS = (".h", ".hpp", ".hh")
_SUFFIXES = {"c": (".c",), "c++": (".cpp", ".cc", ".cxx")}


def load_hand_written(path: Path, diagnostics: Diagnostics) -> Model | None:
    """The model that ``path`` describes.  None if the file has mistakes; all of them are reported."""
    before = diagnostics.error_count
    node = load_yaml(path, diagnostics)
    if node is None or newer_version(node, "version", diagnostics):
        return None
    if not validate(node, load_schema("model"), diagnostics):
        return None
    if "fmu" in node:
        from epg.generator.importers.fmu.fmu_settings import load_fmu_settings  # a large import, which few models need

        return load_fmu_settings(path, node, diagnostics)
    if "importer" in node:
        from epg.generator.importers.recognise import load_by_importer

        return load_by_importer(path, node, diagnostics)
    model = _Reader(path, node, diagnostics).load()
    return model if diagnostics.error_count == before else None


class _Reader:
    """Reads a ``model.yaml`` that fits its schema."""

    def __init__(self, path: Path, node: YamlNode, diagnostics: Diagnostics) -> None:
        self.path = path
        self.node = node
        self.diagnostics = diagnostics
        self.language = self._text("language") or "c"
        self.style = self._text("style") or "struct"
        self.instance = self._text("instance")

    def load(self) -> Model | None:
        before = self.diagnostics.error_count
        step = step_of(self.node["step"], self.diagnostics)
        functions = {key: str(name.value) for key, name in self.node["functions"].items()}
        inputs, outputs = self._ports("inputs"), self._ports("outputs")
        types = self._types()
        parameters, members = self._parameters()
        sources = self._files("sources", _SUFFIXES[self.language])
        directories = self._files("include_dirs", ()) or (self.path.parent,)
        header = self._header(directories)
        if step is None or not sources:
            return None
        fields: dict[str, tuple[BitField | None, ...]] = {}
        considered: list[Path] = []
        if self.diagnostics.error_count == before:
            names = Names(self.path.parent, header, directories, sources, self.language == "c++")
            if names.certain:
                self._check_names(names, members)
            inputs, fields["inputs"] = self._declared(names, types.get("inputs", ""), inputs)
            outputs, fields["outputs"] = self._declared(names, types.get("outputs", ""), outputs)
            parameters, fields["parameters"] = self._declared_parameters(names, parameters, members)
            considered = names.files
        headers = [file for folder in directories for file in source_files(folder, _HEADERS, 0)]
        read = sorted({*sources, *headers})
        return Model(
            name=one_line(self._text("name") or self.path.parent.resolve().name),
            origin="hand-written",
            language=self.language,
            version="",
            method="",
            step=step,
            inputs=inputs,
            outputs=outputs,
            parameters=parameters,
            rounded=rounded_in(" ".join(map(_text, read))),
            directory=self.path.parent,
            files=tuple(sorted({self.path, *read})),
            span=self.node.span,
            searched=tuple(dict.fromkeys((*directories, *(file.parent for file in (*sources, *considered))))),
            considered=tuple(sorted(considered)),
            code=HandWritten(
                style=self.style,
                header=header,
                sources=sources,
                include_dirs=directories,
                instance=self.instance,
                inputs_type=types.get("inputs", ""),
                outputs_type=types.get("outputs", ""),
                init=functions.get("init", ""),
                step=functions["step"],
                terminate=functions.get("terminate", ""),
                stopped=functions.get("stopped", ""),
                finite=functions.get("finite", ""),
                members=members,
                input_fields=fields.get("inputs", ()),
                output_fields=fields.get("outputs", ()),
                parameter_fields=fields.get("parameters", ()),
                renames=self._renames(sources),
                system_headers=self._system_headers([*sources, *headers]),
            ),
        )

    def _error(self, id: str, span: Span, message: str, hint: str = "") -> None:
        self.diagnostics.error(id, span, message, hint=hint)

    def _text(self, *path: str) -> str:
        """The text at ``path``; empty if there is none."""
        node = self.node.get(*path)
        return one_line(str(node.value)) if node is not None and node.value is not None else ""

    # single keys ----------------------------------------------------------------------------------------------------

    def _types(self) -> Mapping[str, str]:
        """The types of the structs with the inputs and the outputs.  Empty with ``style: arrays``."""
        node = self.node.get("types")
        if self.style == "arrays":
            if node is not None:
                span = self.node.key_span("types")
                self._error("unknown-key", span, "'types' has no effect with 'style: arrays'", "remove it")
            return {}
        if node is None:
            hint = "with 'style: struct', write for example 'types: {inputs: pid_inputs_t, outputs: pid_outputs_t}'"
            self._error("missing-key", self.node.span, "'types' must name the structs", hint)
            return {}
        for key in ("inputs", "outputs"):
            if key not in node and (key == "outputs" or self._names("inputs")):
                self._error("missing-key", node.span, f"'{key}' is missing in 'types'", "name the struct in the header")
        return {key: str(name.value) for key, name in node.items()}

    # ports and parameters -------------------------------------------------------------------------------------------

    def _ports(self, section: str) -> tuple[Port, ...]:
        ports = []
        for index, name in enumerate(self._names(section)):
            span = self.node[section].key_span(name)
            if is_reserved(name):
                self._error(
                    "invalid-name", span, f"'{name}' is not a C identifier", "write the name of a member of the struct"
                )
            unit, type, description = (self._text(section, name, key) for key in ("unit", "type", "description"))
            direction = section.removesuffix("s")
            ports.append(Port(name, to_identifier(name), direction, unit, type or "real", index, span, description))
        check_identifiers(ports, self.diagnostics)
        return tuple(ports)

    def _names(self, section: str) -> list[str]:
        node = self.node.get(section)
        return [name for name, _ in node.items()] if node is not None else []

    def _parameters(self) -> tuple[tuple[Parameter, ...], tuple[str, ...]]:
        parameters: list[Parameter] = []
        members: list[str] = []
        taken: set[str] = set()
        for index, name in enumerate(self._names("parameters")):
            span = self.node["parameters"].key_span(name)
            number = self.node.get("parameters", name, "value") or self.node["parameters"][name]
            assert isinstance(number.value, (int, float))
            if not math.isfinite(float(number.value)):
                self._error("wrong-value", number.span, f"parameter '{name}' must be finite")
            member = self._text("parameters", name, "member") or name
            if not _MEMBER.fullmatch(member):
                what = "member of the instance" if self.instance else "variable of the header"
                self._error("invalid-name", span, f"'{member}' is not a {what}", "set 'member' to its name in C")
            identifier = to_identifier(name)
            if identifier in taken:
                message = f"'{name}' has the same C identifier as another parameter"
                self._error("invalid-name", span, message, "rename it")
            taken.add(identifier)
            unit = self._text("parameters", name, "unit")
            parameters.append(Parameter(name, identifier, float(number.value), unit, index, span))
            members.append(member)
        return tuple(parameters), tuple(members)

    def _check_names(self, names: Names, members: tuple[str, ...]) -> None:
        """Reports names of functions, types, parameters and ports that do not exist in the sources."""
        for _, node in self.node["functions"].items():
            names.check_function(str(node.value), node.span, self.diagnostics)
        if self.instance:
            names.check_type(self.instance, self.node["instance"].span, self.diagnostics)
        types = self.node.get("types")
        for key, node in types.items() if types is not None else ():
            names.check_type(str(node.value), node.span, self.diagnostics)
            for port in self._names(key):
                names.check_member(str(node.value), port, self.node[key].key_span(port), self.diagnostics)
        for name, member in zip(self._names("parameters"), members, strict=True):
            written = self.node.get("parameters", name, "member")
            span = written.span if written is not None else self.node["parameters"].key_span(name)
            if self.instance:
                names.check_member(self.instance, member, span, self.diagnostics)
            else:
                names.check_variable(member, span, self.diagnostics)

    def _declared(
        self, names: Names, type: str, ports: tuple[Port, ...]
    ) -> tuple[tuple[Port, ...], tuple[BitField | None, ...]]:
        """The ports with the types of their members, and the bit-fields among these members."""
        result, fields = [], []
        for port in ports:
            declaration = names.declaration(type, port.name) if type else None
            whole = declaration is not None and is_integer(declaration)
            result.append(replace(port, whole=port.type == "integer" or (whole and port.type == "real")))
            field = None
            if declaration is not None and declaration.width and port.type != "boolean":
                field = self._bit_field(names, declaration, port.name, port.span)
            fields.append(field)
        return tuple(result), tuple(fields)

    def _declared_parameters(
        self, names: Names, parameters: tuple[Parameter, ...], members: tuple[str, ...]
    ) -> tuple[tuple[Parameter, ...], tuple[BitField | None, ...]]:
        """The parameters with their bit-fields.  Reports values outside of the types of their members."""
        result, fields = [], []
        for parameter, member in zip(parameters, members, strict=True):
            declaration = names.declaration(self.instance, member) if self.instance else None
            field = None
            if declaration is not None and declaration.width:
                field = self._bit_field(names, declaration, member, parameter.span)
            limits = (field.low, field.high) if field else declaration and integer_range(declaration, None)
            if limits and not limits[0] <= parameter.value <= limits[1]:
                message = (
                    f"{parameter.value:g} is outside of the range of '{member}', which is {limits[0]} to {limits[1]}"
                )
                hint = "write a value in this range, or give the member a wider type"
                self._error("out-of-range", parameter.span, message, hint)
            whole = declaration is not None and is_integer(declaration)
            result.append(replace(parameter, whole=whole))
            fields.append(field)
        return tuple(result), tuple(fields)

    def _bit_field(self, names: Names, declaration: Declaration, member: str, span: Span) -> BitField | None:
        """The range of a bit-field.  Reports a width or a type that does not tell it."""
        bits = names.number(declaration.width)
        if bits is None or not 1 <= bits <= 64:
            message = f"the width of bit-field '{member}' is not a number: '{declaration.width}'"
            self._error("wrong-value", span, message, f"write the number of bits, such as 'unsigned int {member} : 3'")
            return None
        limits = integer_range(declaration, bits)
        if limits is None:
            message = f"the type of bit-field '{member}' does not tell its range: '{' '.join(declaration.type)}'"
            hint = f"make it signed or unsigned, such as 'unsigned int {member} : {bits}'"
            self._error("wrong-value", span, message, hint)
            return None
        return BitField(*limits)

    # files ----------------------------------------------------------------------------------------------------------

    def _files(self, key: str, suffixes: tuple[str, ...]) -> tuple[Path, ...]:
        """The files or folders in the list ``key``.  Without ``suffixes``, they are folders."""
        node = self.node.get(key)
        if node is None:
            return ()
        result: list[Path] = []
        for element in node.elements():
            name = str(element.value)
            path = self.path.parent / name
            if suffixes and path.suffix.lower() not in suffixes:
                hint = f"the sources of this language must end in {', '.join(suffixes)}; 'language' can be c or c++"
                self._error("wrong-value", element.span, f"'{name}' has the wrong suffix", hint)
            elif not (is_file(path) if suffixes else is_folder(path)):
                self._no_file(element, path, suffixes)
            elif suffixes and suffixes != _SUFFIXES["c"] and not is_includable(name):
                message = f"'{name}' cannot be included"
                self._error("invalid-name", element.span, message, "rename the file; use '/' in paths")
            else:
                result.append(path)
        return tuple(dict.fromkeys(result))

    def _no_file(self, element: YamlNode, path: Path, suffixes: tuple[str, ...]) -> None:
        folder = path.parent if is_folder(path.parent) else self.path.parent
        known = [entry.name for entry in sorted(folder.iterdir()) if not suffixes or entry.suffix in suffixes]
        message = f"there is no {'file' if suffixes else 'folder'} '{element.value}'"
        hint = did_you_mean(str(element.value), known, "files in that folder")
        self._error("file-not-found", element.span, message, hint)

    def _header(self, directories: tuple[Path, ...]) -> str:
        name = str(self.node["header"].value)
        if not any(is_file(folder / name) for folder in directories):
            node = self.node["header"]
            known = [entry.name for folder in directories for entry in source_files(folder, _HEADERS, 0)]
            self._error(
                "file-not-found", node.span, f"there is no header '{name}'", did_you_mean(name, known, "headers")
            )
        if not is_includable(name):
            self._error(
                "invalid-name", self.node["header"].span, f"'{name}' is not the name of a header", "use '/' in paths"
            )
        return name

    def _parse(self, paths: Iterable[Path]) -> list[CFile]:
        files = [read_source(path, self.diagnostics) for path in paths]
        return [parse_code(file) for file in files if file is not None]

    def _renames(self, sources: Iterable[Path]) -> tuple[str, ...]:
        """The global symbols of C sources, which generated macros rename.  Empty for C++."""
        if self.language != "c":
            return ()
        codes = self._parse(sources)
        names = {name for code in codes for name in code.global_names()}
        return tuple(sorted(names - {macro.name for code in codes for macro in code.macros}))

    def _system_headers(self, files: Iterable[Path]) -> tuple[str, ...]:
        """The headers of the system that C++ code includes.  Empty for C."""
        if self.language != "c++":
            return ()
        codes = self._parse(files)
        return tuple(sorted({include.name for code in codes for include in code.includes if include.system}))


def _text(path: Path) -> str:
    """The text of a source file without its comments; empty if it cannot be read."""
    try:
        return SourceFile(path, path.read_text(encoding="utf-8", errors="replace")).without_comments
    except OSError:
        return ""
