# SPDX-License-Identifier: Apache-2.0
"""Reads the ``model.yaml`` of a controller written by hand: its ports, step size and functions.

The whole file is checked here.  ``schemas/model.schema.json`` has the same rules for editors; both must agree.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from pathlib import Path

from epg.diagnostics import Diagnostics, did_you_mean
from epg.documents.source_file import is_includable, read_source
from epg.documents.text_file import is_file, is_folder, one_line
from epg.documents.yaml_file import load_yaml
from epg.models import details
from epg.models.c_code import parse_code
from epg.models.folders import source_files
from epg.models.hand_written_names import Names
from epg.models.identifiers import is_reserved, to_identifier
from epg.models.model import Model, Parameter, Port
from epg.models.model_yaml import ModelYaml
from epg.models.ports import check_identifiers
from epg.source import Span, YamlNode

_KEYS = {
    "version": "number",
    "name": "identifier",
    "description": "text",
    "step": "quantity",
    "language": "word",
    "sources": "list",
    "include_dirs": "list",
    "header": "text",
    "style": "word",
    "instance": "type",
    "types": "map",
    "functions": "map",
    "inputs": "map",
    "outputs": "map",
    "parameters": "map",
}
_REQUIRED = ("version", "step", "sources", "header", "functions", "outputs")
_FUNCTIONS = ("init", "step", "terminate", "stopped", "finite")
_PORT_KEYS = ("unit", "type", "description")
_PARAMETER_KEYS = ("value", "unit", "member", "description")
_TYPE = re.compile(r"(?:struct )?[A-Za-z_]\w*(?:::[A-Za-z_]\w*)*", re.ASCII)
_IDENTIFIER = re.compile(r"[A-Za-z_]\w{0,62}", re.ASCII)
_MEMBER = re.compile(r"[A-Za-z_]\w*(?:\.[A-Za-z_]\w*|\[\d{1,9}\])*", re.ASCII)
_SUFFIXES = {"c": (".c",), "c++": (".cpp", ".cc", ".cxx")}


def load_hand_written(path: Path, diagnostics: Diagnostics) -> Model | None:
    """The model that ``path`` describes.  None if the file has mistakes; all of them are reported."""
    before = diagnostics.error_count
    node = load_yaml(path, diagnostics)
    if node is None:
        return None
    model = _load(path, node, diagnostics)
    return model if diagnostics.error_count == before else None


def _load(path: Path, node: YamlNode, diagnostics: Diagnostics) -> Model | None:
    if "fmu" in node:
        from epg.models.fmu_settings import FmuSettings  # a large import, which few models need

        return FmuSettings(path, node, diagnostics).load()
    return _Reader(path, node, diagnostics).load()


class _Reader(ModelYaml):
    """Reads the ``model.yaml`` of a controller written by hand."""

    def load(self) -> Model | None:
        self.before = self.diagnostics.error_count
        if not self._begin(tuple(_KEYS), _REQUIRED):
            return None
        language = self._choice("language", ("c", "c++"), "c")
        style = self._choice("style", ("struct", "arrays"), "struct")
        step = self._step()
        functions = self._functions(language)
        inputs, outputs = self._ports("inputs"), self._ports("outputs")
        instance = self._type(self.node.get("instance"), "instance")
        types = self._types(style)
        parameters, members = self._parameters(instance)
        sources = self._files("sources", _SUFFIXES.get(language, (".c", ".cpp", ".cc", ".cxx")))
        directories = self._files("include_dirs", ()) or (self.path.parent,)
        header = self._header(directories)
        if step is None or functions is None or not sources:
            return None
        if self.diagnostics.error_count == self.before:
            names = Names(self.path.parent, header, directories, sources, language == "c++")
            if names.certain:
                self._check_names(names, instance, members)
        read = {file for file in sources if file.is_file()}
        headers = [file for folder in directories for file in source_files(folder, (".h", ".hpp", ".hh"), 0)]
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
            directory=self.path.parent,
            files=tuple(sorted({self.path, *read, *headers})),
            span=self.node.span,
            details=details.HandWritten(
                style=style,
                header=header,
                sources=sources,
                include_dirs=directories,
                instance=instance,
                inputs_type=types[0],
                outputs_type=types[1],
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

    # single keys ----------------------------------------------------------------------------------------------------

    def _choice(self, key: str, choices: tuple[str, ...], default: str) -> str:
        node = self.node.get(key)
        if node is None:
            return default
        if node.value not in choices:
            hint = did_you_mean(str(node.value), choices)
            self._error("wrong-value", node.span, f"'{node.value}' is not possible here", hint)
            return ""
        return str(node.value)

    def _type(self, node: YamlNode | None, key: str) -> str:
        if node is None:
            return ""
        if not isinstance(node.value, str) or not _TYPE.fullmatch(node.value):
            self._error("wrong-value", node.span, f"'{key}' must name a type of the header", "such as pid_t")
            return ""
        return node.value

    def _types(self, style: str) -> tuple[str, str]:
        """The types of the structs with the inputs and the outputs.  Empty with ``style: arrays``."""
        node = self.node.get("types")
        if not style:
            return "", ""
        if style == "arrays":
            if node is not None:
                span = self.node.key_span("types")
                self._error("unknown-key", span, "'types' has no meaning with 'style: arrays'", "remove it")
            return "", ""
        if node is None or not node.is_mapping:
            span = node.span if node else Span(str(self.path), 1, 1, 2)
            hint = "with 'style: struct', write for example 'types: {inputs: pid_inputs_t, outputs: pid_outputs_t}'"
            self._error("missing-key" if node is None else "wrong-type", span, "'types' must name the structs", hint)
            return "", ""
        self._known_keys(node, ("inputs", "outputs"), " in 'types'")
        for key in ("inputs", "outputs"):
            if key not in node and not (key == "inputs" and not self._has_inputs()):
                self._error("missing-key", node.span, f"'{key}' is missing in 'types'", "name the struct in the header")
        return self._type(node.get("inputs"), "inputs"), self._type(node.get("outputs"), "outputs")

    def _has_inputs(self) -> bool:
        node = self.node.get("inputs")
        return node is not None and any(True for _ in node.items())

    def _functions(self, language: str) -> Mapping[str, str] | None:
        node = self.node.get("functions")
        if node is None:
            return None
        if not node.is_mapping:
            self._error(
                "wrong-type", node.span, "'functions' is a map", "write for example {init: pid_init, step: pid_step}"
            )
            return None
        self._known_keys(node, _FUNCTIONS, " in 'functions'")
        if "step" not in node:
            self._error(
                "missing-key", node.span, "'step' is missing in 'functions'", "name the function that makes one step"
            )
        result: dict[str, str] = {}
        for key, value in node.items():
            pattern = _TYPE if language == "c++" else _IDENTIFIER
            if not isinstance(value.value, str) or not pattern.fullmatch(value.value):
                self._error("wrong-value", value.span, f"'{key}' must name a function of the header", "")
            elif key in _FUNCTIONS:
                result[key] = value.value
        return result if "step" in result else None

    # ports and parameters -------------------------------------------------------------------------------------------

    def _ports(self, key: str) -> tuple[Port, ...]:
        node = self.node.get(key)
        if node is None or node.value is None:
            return ()
        direction = key.removesuffix("s")
        if not node.is_mapping:
            self._error(
                "wrong-type", node.span, f"'{key}' is a map of ports", "write for example {position: {unit: rad}}"
            )
            return ()
        ports = []
        for index, (name, value) in enumerate(node.items()):
            span = node.key_span(name)
            if not _IDENTIFIER.fullmatch(name) or is_reserved(name):
                self._error("invalid-name", span, f"'{name}' is not a C identifier", "it names a member of the struct")
            if value.value is not None and not value.is_mapping:
                self._error("wrong-type", value.span, f"port '{name}' is a map", "write {} or {unit: rad}")
                continue
            self._known_keys(value, _PORT_KEYS, f" of port '{name}'")
            kind = value.get("type")
            if kind is not None and kind.value not in ("real", "integer", "boolean"):
                hint = did_you_mean(str(kind.value), ("real", "integer", "boolean"))
                self._error("wrong-value", kind.span, f"'{kind.value}' is not a type of a port", hint)
                kind = None
            ports.append(
                Port(
                    name,
                    to_identifier(name),
                    direction,
                    self._word(value, "unit"),
                    str(kind.value) if kind else "real",
                    index,
                    span,
                    self._word(value, "description"),
                )
            )
        check_identifiers(ports, self.diagnostics)
        return tuple(ports)

    def _parameters(self, instance: str) -> tuple[tuple[Parameter, ...], tuple[str, ...]]:
        node = self.node.get("parameters")
        if node is None or node.value is None:
            return (), ()
        if not node.is_mapping:
            self._error("wrong-type", node.span, "'parameters' is a map", "write for example {kp: {value: 2.0}}")
            return (), ()
        parameters: list[Parameter] = []
        members: list[str] = []
        taken: set[str] = set()
        for index, (name, value) in enumerate(node.items()):
            span = node.key_span(name)
            number = value if not value.is_mapping else value.get("value")
            if value.is_mapping:
                self._known_keys(value, _PARAMETER_KEYS, f" of parameter '{name}'")
            if number is None or isinstance(number.value, bool) or not isinstance(number.value, (int, float)):
                where = number.span if number else span
                self._error("wrong-type", where, f"parameter '{name}' needs a number", "write for example {value: 2.0}")
                continue
            if not math.isfinite(float(number.value)):
                self._error("wrong-value", number.span, f"parameter '{name}' must be finite", "")
                continue
            member = self._word(value, "member") or name
            if not _MEMBER.fullmatch(member):
                what = "member of the instance" if instance else "variable of the header"
                self._error("invalid-name", span, f"'{member}' is not a {what}", "set 'member'")
                continue
            identifier = to_identifier(name)
            if identifier in taken:
                self._error(
                    "invalid-name", span, f"'{name}' becomes the C identifier of another parameter", "rename it"
                )
            taken.add(identifier)
            parameters.append(Parameter(name, identifier, float(number.value), self._word(value, "unit"), index, span))
            members.append(member)
        return tuple(parameters), tuple(members)

    def _word(self, node: YamlNode, key: str) -> str:
        found = node.get(key)
        if found is None or found.value is None:
            return ""
        if not isinstance(found.value, str):
            self._error("wrong-type", found.span, f"'{key}' must be text", "put it into quotes")
            return ""
        return one_line(found.value)

    def _check_names(self, names: Names, instance: str, members: tuple[str, ...]) -> None:
        """Reports names of functions, types, parameters and ports that do not exist in the sources."""
        for _, node in self.node["functions"].items():
            names.check_function(str(node.value), node.span, self.diagnostics)
        if instance:
            names.check_type(instance, self.node["instance"].span, self.diagnostics)
        types = self.node.get("types")
        for key, node in types.items() if types is not None else ():
            names.check_type(str(node.value), node.span, self.diagnostics)
            ports = self.node.get(key)
            for port, _ in ports.items() if ports is not None else ():
                names.check_member(str(node.value), port, self.node[key].key_span(port), self.diagnostics)
        parameters = self.node.get("parameters")
        entries = list(parameters.items()) if parameters is not None else []
        for (name, node), member in zip(entries, members, strict=True):
            written = node.get("member")
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
        if not node.is_sequence or not node.elements():
            self._error("wrong-type", node.span, f"'{key}' must be a list", "write for example [pid.c]")
            return ()
        result: list[Path] = []
        for element in node.elements():
            if not isinstance(element.value, str) or not element.value:
                self._error("wrong-type", element.span, "expected the name of a file or folder", "")
                continue
            path = self.path.parent / element.value
            if suffixes and path.suffix.lower() not in suffixes:
                hint = f"sources of this language end in {', '.join(suffixes)}; 'language' is c or c++"
                self._error("wrong-value", element.span, f"'{element.value}' has another suffix", hint)
            elif not (is_file(path) if suffixes else is_folder(path)):
                folder = path.parent if is_folder(path.parent) else self.path.parent
                known = [entry.name for entry in sorted(folder.iterdir()) if not suffixes or entry.suffix in suffixes]
                message = f"there is no {'file' if suffixes else 'folder'} '{element.value}'"
                self._error(
                    "file-not-found", element.span, message, did_you_mean(element.value, known, "in that folder")
                )
            elif suffixes and suffixes != _SUFFIXES["c"] and not is_includable(element.value):
                message = f"'{element.value}' cannot be included"
                self._error("invalid-name", element.span, message, "rename the file; use '/' in paths")
            else:
                result.append(path)
        return tuple(dict.fromkeys(result))

    def _header(self, directories: tuple[Path, ...]) -> str:
        name = self._text("header")
        if name and not any(is_file(folder / name) for folder in directories):
            node = self.node["header"]
            known = [entry.name for folder in directories for entry in source_files(folder, (".h", ".hpp", ".hh"), 0)]
            self._error(
                "file-not-found", node.span, f"there is no header '{name}'", did_you_mean(name, known, "headers")
            )
        if name and not is_includable(name):
            self._error(
                "invalid-name", self.node["header"].span, f"'{name}' is no name of a header", "use '/' in paths"
            )
        return name

    def _renames(self, sources: tuple[Path, ...]) -> tuple[str, ...]:
        """The global symbols of C sources, which generated macros rename."""
        names: set[str] = set()
        macros: set[str] = set()
        for path in sources:
            file = read_source(path, self.diagnostics)
            if file is None:
                continue
            code = parse_code(file)
            names |= {function.name for function in code.functions if not function.static}
            names |= {variable.name for variable in code.variables if not variable.static}
            macros |= {macro.name for macro in code.macros}
        return tuple(sorted(names - macros))

    def _system_headers(self, files: list[Path]) -> tuple[str, ...]:
        names: set[str] = set()
        for path in files:
            file = read_source(path, self.diagnostics)
            if file is not None:
                names |= {include.name for include in parse_code(file).includes if include.system}
        return tuple(sorted(names))
