# SPDX-License-Identifier: Apache-2.0
"""Reads the ``model.yaml`` of a controller written by hand: its ports, step size and functions.

``schemas/model.schema.json`` has the rules for the form of the file.  This module checks what a schema cannot check.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from epg.diagnostics import Diagnostics, did_you_mean
from epg.documents.schema import load_schema, validate
from epg.documents.source_file import SourceFile, is_includable, read_source
from epg.documents.text_file import is_file, is_folder, one_line
from epg.documents.yaml_file import load_yaml, newer_version
from epg.models import details
from epg.models.c_code import Code, parse_code
from epg.models.features import rounded_in
from epg.models.folders import source_files
from epg.models.hand_written_names import Names
from epg.models.identifiers import is_reserved, to_identifier
from epg.models.model import Model, Parameter, Port
from epg.models.model_yaml import step_of
from epg.models.ports import check_identifiers
from epg.source import Span, YamlNode

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
        from epg.models.fmu_settings import load_fmu_settings  # a large import, which few models need

        return load_fmu_settings(path, node, diagnostics)
    model = _Reader(path, node, diagnostics).load()
    return model if diagnostics.error_count == before else None


class _Reader:
    """Reads a ``model.yaml`` that fits its schema."""

    def __init__(self, path: Path, node: YamlNode, diagnostics: Diagnostics) -> None:
        self.path = path
        self.node = node
        self.diagnostics = diagnostics

    def load(self) -> Model | None:
        before = self.diagnostics.error_count
        language, style = self._text("language") or "c", self._text("style") or "struct"
        step = step_of(self.node["step"], self.diagnostics)
        functions = {key: str(name.value) for key, name in self.node["functions"].items()}
        inputs, outputs = self._ports("inputs"), self._ports("outputs")
        instance = self._text("instance")
        types = self._types(style)
        parameters, members = self._parameters(instance)
        sources = self._files("sources", _SUFFIXES[language])
        directories = self._files("include_dirs", ()) or (self.path.parent,)
        header = self._header(directories)
        if step is None or not sources:
            return None
        if self.diagnostics.error_count == before:
            names = Names(self.path.parent, header, directories, sources, language == "c++")
            if names.certain:
                self._check_names(names, instance, members)
        read = {file for file in sources if file.is_file()}
        headers = [file for folder in directories for file in source_files(folder, _HEADERS, 0)]
        return Model(
            name=one_line(self._text("name") or self.path.parent.resolve().name),
            origin="hand-written",
            language=language,
            version="",
            method="",
            step=step,
            inputs=inputs,
            outputs=outputs,
            parameters=parameters,
            rounded=rounded_in(" ".join(_text(file) for file in sorted({*read, *headers}))),
            directory=self.path.parent,
            files=tuple(sorted({self.path, *read, *headers})),
            span=self.node.span,
            details=details.HandWritten(
                style=style,
                header=header,
                sources=sources,
                include_dirs=directories,
                instance=instance,
                inputs_type=types.get("inputs", ""),
                outputs_type=types.get("outputs", ""),
                init=functions.get("init", ""),
                step=functions["step"],
                terminate=functions.get("terminate", ""),
                stopped=functions.get("stopped", ""),
                finite=functions.get("finite", ""),
                members=members,
                renames=self._renames(sources) if language == "c" else (),
                system_headers=self._system_headers([*sources, *headers]) if language == "c++" else (),
            ),
        )

    def _error(self, id: str, span: Span, message: str, hint: str = "") -> None:
        self.diagnostics.error(id, span, message, hint=hint)

    def _text(self, *path: str) -> str:
        """The text at ``path``; empty if there is none."""
        node = self.node.get(*path)
        return one_line(str(node.value)) if node is not None and node.value is not None else ""

    # single keys ----------------------------------------------------------------------------------------------------

    def _types(self, style: str) -> Mapping[str, str]:
        """The types of the structs with the inputs and the outputs.  Empty with ``style: arrays``."""
        node = self.node.get("types")
        if style == "arrays":
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

    def _parameters(self, instance: str) -> tuple[tuple[Parameter, ...], tuple[str, ...]]:
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
                what = "member of the instance" if instance else "variable of the header"
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

    def _check_names(self, names: Names, instance: str, members: tuple[str, ...]) -> None:
        """Reports names of functions, types, parameters and ports that do not exist in the sources."""
        for _, node in self.node["functions"].items():
            names.check_function(str(node.value), node.span, self.diagnostics)
        if instance:
            names.check_type(instance, self.node["instance"].span, self.diagnostics)
        types = self.node.get("types")
        for key, node in types.items() if types is not None else ():
            names.check_type(str(node.value), node.span, self.diagnostics)
            for port in self._names(key):
                names.check_member(str(node.value), port, self.node[key].key_span(port), self.diagnostics)
        for name, member in zip(self._names("parameters"), members, strict=True):
            written = self.node.get("parameters", name, "member")
            span = written.span if written is not None else self.node["parameters"].key_span(name)
            if instance:
                names.check_member(instance, member, span, self.diagnostics)
            else:
                names.check_variable(member, span, self.diagnostics)

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
                folder = path.parent if is_folder(path.parent) else self.path.parent
                known = [entry.name for entry in sorted(folder.iterdir()) if not suffixes or entry.suffix in suffixes]
                message = f"there is no {'file' if suffixes else 'folder'} '{name}'"
                self._error("file-not-found", element.span, message, did_you_mean(name, known, "files in that folder"))
            elif suffixes and suffixes != _SUFFIXES["c"] and not is_includable(name):
                message = f"'{name}' cannot be included"
                self._error("invalid-name", element.span, message, "rename the file; use '/' in paths")
            else:
                result.append(path)
        return tuple(dict.fromkeys(result))

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

    def _parse(self, paths: Iterable[Path]) -> list[Code]:
        files = [read_source(path, self.diagnostics) for path in paths]
        return [parse_code(file) for file in files if file is not None]

    def _renames(self, sources: Iterable[Path]) -> tuple[str, ...]:
        """The global symbols of C sources, which generated macros rename."""
        codes = self._parse(sources)
        names = {name for code in codes for name in code.global_names()}
        return tuple(sorted(names - {macro.name for code in codes for macro in code.macros}))

    def _system_headers(self, files: Iterable[Path]) -> tuple[str, ...]:
        codes = self._parse(files)
        return tuple(sorted({include.name for code in codes for include in code.includes if include.system}))


def _text(path: Path) -> str:
    """The text of a source file without its comments; empty if it cannot be read."""
    try:
        return SourceFile(path, path.read_text(encoding="utf-8", errors="replace")).without_comments
    except OSError:
        return ""
