# SPDX-License-Identifier: Apache-2.0
"""Imports exports of 20-sim's C++ class target: ``<Sub>.cpp``, ``<Sub>.h`` and ``common/``."""

from __future__ import annotations

import re
from fractions import Fraction

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import is_includable
from epg.generator.importers.cpp_class.cpp_class_export import CppClassExport
from epg.generator.models.assignments import assignments
from epg.generator.models.c_code import CFile, integer_value, typedefs
from epg.generator.models.completeness import check_methods
from epg.generator.models.export import ExportReader
from epg.generator.models.features import FIXED_STEP_METHODS, check_features, check_method
from epg.generator.models.link import Linked, link
from epg.generator.models.metadata import find_metadata
from epg.generator.models.model import Model, Port
from epg.generator.models.ports import check_identifiers, make_parameters, make_ports
from epg.generator.source import Span

SUFFIXES = (".cpp", ".cc", ".cxx")


def submodel_classes(code: CFile) -> list[str]:
    """The names of the classes in ``code`` that have the methods of a 20-sim submodel."""
    methods: dict[str, set[str]] = {}
    for function in code.functions:
        if function.owner:
            methods.setdefault(function.owner, set()).add(function.name)
    return [
        owner
        for owner, names in sorted(methods.items())
        if {"Initialize", "Calculate"} <= names and names & {"CopyInputsToVariables", "CopyVariablesToOutputs"}
    ]


def load_cpp_class(main: CFile, diagnostics: Diagnostics) -> Model | None:
    """The model whose class ``main`` defines.  None if it cannot be used; the reasons are reported."""
    before = diagnostics.error_count
    linked = link(main, SUFFIXES, diagnostics)
    if linked is None or diagnostics.error_count > before:
        return None
    for code in linked.units:
        if not is_includable(code.file.path.name):
            message = f"'{code.file.path.name}' cannot be included"
            diagnostics.error("invalid-name", code.file.span(0), message, hint="rename the file")
            return None
    return _Importer(linked, submodel_classes(main)[0], diagnostics).load()


class _Importer(ExportReader):
    def __init__(self, linked: Linked, class_name: str, diagnostics: Diagnostics) -> None:
        super().__init__(linked, diagnostics)
        self.class_name = class_name
        self.methods = {f.name: f for f in self.main.functions if f.owner == class_name}
        at = self.methods["Calculate"].start
        self.whole = self.file.span(at, at + len(class_name) + len("::Calculate"))
        self.metadata = find_metadata(self.file.path, class_name, diagnostics)

    def load(self) -> Model | None:
        before = self.diagnostics.error_count
        step = self._step()
        method, method_code, method_at = self._method()
        check_method(method, method_code.file.word_span(method_at), self.diagnostics)
        roots = list(self.methods.values())
        roots += [f for _, f in self.linked.functions() if f.owner == method and f.name in ("Initialize", "Step")]
        rounded = check_features(self.linked, roots, self.diagnostics)
        for name in (self.class_name, method):
            check_methods(self.linked, name, self.diagnostics)
        ports = [self._ports("input"), self._ports("output")]
        if step is None or self.diagnostics.error_count > before:
            return None
        array = self._prefix() + "P"
        body = self.methods["Initialize"]
        lines = [line for line in assignments(self.file, body.body_start, body.body_end) if line.array == array]
        tokens = self.metadata.tokens
        names = tokens.names("PARAMETER") if tokens else []
        parameters, places = make_parameters(lines, names if len(names) == self._count("parameters") else [], ())
        model = Model(
            name=self.class_name,
            origin="20-sim C++ class",
            language="c++",
            **self.common(ports),
            method=method,
            step=step,
            parameters=parameters,
            rounded=rounded,
            code=CppClassExport(
                linked=self.linked,
                class_name=self.class_name,
                real=self._real_type(),
                methods=frozenset(self.methods),
                members=frozenset(self._members()),
                state_count=self._count("states"),
                parameters=array,
                states=self._prefix() + "s",
                rates=self._prefix() + "R",
                places=self.places(places),
            ),
        )
        return model if self.agrees(model, self._prefix()) else None

    def _prefix(self) -> str:
        match = re.search(r"\b(\w{0,80}?)step_size\s*=", self.file.code, re.ASCII)
        return match[1] if match else "m_"

    def _place_of(self, word: str) -> tuple[Span, str] | None:
        """The place and the text of the first value that is assigned to the member ``<prefix><word>``."""
        match = re.search(rf"\b{re.escape(self._prefix())}{word}\s*=\s*([^=;]+);", self.file.code)
        return (self.file.span(match.start(), match.end()), match[1].strip()) if match else None

    def _step(self) -> Fraction | None:
        hint = f"{self.class_name}::Reset() must set it, for example 'm_step_size = 0.001;'"
        return self.checked_step(self._place_of("step_size"), hint)

    def _count(self, what: str) -> int:
        place = self._place_of(f"number_{what}")
        return (integer_value(place[1], self.linked.macros()) or 0) if place else 0

    def _method(self) -> tuple[str, CFile, int]:
        """The integration method and its place: the type of the member whose ``Step()`` is called by Calculate."""
        body = self.methods["Calculate"]
        match = re.search(r"\b(\w+)\s*(?:\.|->)\s*Step\s*\(", self.main.body(body))
        if match:
            member = re.escape(match[1])
            for code in (*self.linked.headers, self.main):
                declared = re.search(rf"\b(\w+)\s*\*?\s+\*?{member}\s*;", code.file.code)
                if declared:
                    return declared[1], code, declared.start(1)
        for method in FIXED_STEP_METHODS:
            called = re.search(rf"\b{method}\w*Step\s*\(", self.main.body(body))
            if called:
                return method, self.main, body.body_start + called.start()
        return "", self.main, body.start

    def _ports(self, direction: str) -> tuple[Port, ...]:
        lines = self.port_lines(((self.main, method) for method in self.methods.values()), direction)
        tokens = self.metadata.tokens
        names = tokens.named(direction.upper()) if tokens else []
        stated = self._place_of(f"number_of_{direction}s") or self._place_of(f"number_{direction}s")
        count = integer_value(stated[1], {}) if stated else None
        ports = make_ports(lines, direction, names, self.metadata.configuration, self.diagnostics, self.whole, count)
        check_identifiers(ports, self.diagnostics)
        return ports

    def _members(self) -> set[str]:
        """The data members of the class and its bases that the generated wrapper can use."""
        wanted = {self._prefix() + word for word in ("stop_run", "stop_simulation", "finish_time", "time")}
        return {name for code in self.linked.headers for name in wanted if re.search(rf"\b{name}\s*;", code.file.code)}

    def _real_type(self) -> str:
        for code in self.linked.headers:
            for name, base in typedefs(code):
                if name == "XXDouble":
                    return base
        return "double"
