# SPDX-License-Identifier: Apache-2.0
"""Imports exports of 20-sim's C function target (versions 4.5 to 5.1), and the C sources of its FMU target.

Users change the prefix or the suffix of all names to link two models.  The importer therefore recognises the entry
points by the middle of their names (``...InitializeSubmodel...``), and reads the prefix and the suffix from the name
of the variable that holds the step size.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import SourceFile, read_source
from epg.generator.documents.text_file import one_line
from epg.generator.importers.c_function.c_function_export import CFunctionExport, EntryPoint, PortElement
from epg.generator.models.assignments import ArrayAssignment, PortLine, assignments, exact_number, listed_names
from epg.generator.models.c_code import CFile, Function, integer_value, typedefs
from epg.generator.models.code_parts import SourceRange
from epg.generator.models.completeness import check_variables
from epg.generator.models.export import ExportReader, parameters_of
from epg.generator.models.features import check_features, check_method
from epg.generator.models.folders import source_files
from epg.generator.models.global_variables import base_type, global_variables
from epg.generator.models.link import Linked, link
from epg.generator.models.metadata import find_metadata
from epg.generator.models.model import Model, Port
from epg.generator.models.ports import check_identifiers, make_parameters, make_ports
from epg.generator.source import Span

SUFFIXES = (".c",)
_ENTRY = re.compile(r"\w*?(Initialize|Calculate|Terminate)Submodel\w*")
_METHODS = re.compile(r"(Discrete|Euler|RungeKutta2|RungeKutta4|MeBDFi|VodeAdams|BDF|AdamsBashford2?|Vode\w*)")
_SCALAR = re.compile(r"(?<!\w)((?:\w{1,255}->)?\w{1,255})\s{0,80}=(?!=)\s{0,80}([^=;]+);", re.ASCII)
_MEMORY_COUNTS = "constants_count parameter_count initialvalue_count variable_count state_count state_count".split()


def entry_points(code: CFile) -> dict[str, Function]:
    """The functions ``Initialize``, ``Calculate`` and ``Terminate`` of a submodel that ``code`` defines."""
    functions: dict[str, Function] = {}
    for function in code.functions:
        match = _ENTRY.fullmatch(function.name)
        if match and not function.owner:
            functions.setdefault(match[1], function)
    return functions


def is_c_function(code: CFile) -> bool:
    """True if ``code`` defines the entry points of a submodel."""
    return {"Initialize", "Calculate"} <= entry_points(code).keys()


def load_c_function(main: CFile, diagnostics: Diagnostics) -> Model | None:
    """The model whose entry points ``main`` defines.  None if it cannot be used; the reasons are reported."""
    before = diagnostics.error_count
    linked = link(main, SUFFIXES, diagnostics)
    if linked is None:
        return None
    return _Importer(linked, diagnostics).load() if diagnostics.error_count == before else None


class _Importer(ExportReader):
    def __init__(self, linked: Linked, diagnostics: Diagnostics) -> None:
        super().__init__(linked, diagnostics)
        self.entries = entry_points(linked.main)
        self.whole = self.file.span(self.entries["Calculate"].start, self.entries["Calculate"].start + 1)
        self.macros = linked.macros()
        self.variables = {v.name: (c, v) for c in linked.units for v in c.variables if not v.static}
        self.types: dict[str, str] = {
            name: base.removeprefix("const ") for code in linked.all for name, base in typedefs(code)
        }
        self.metadata = find_metadata(self.file.path, self._name(), diagnostics)
        self.instance_type = self._instance_type()

    def load(self) -> Model | None:
        before = self.diagnostics.error_count
        initialize = self._model_initialize()
        roots = [*self.entries.values(), *self._static(), *([initialize] if initialize else [])]
        step = self._step()
        method, method_code, method_at = self._method()
        check_method(method, method_code.file.word_span(method_at), self.diagnostics)
        rounded = check_features(self.linked, roots, self.diagnostics)
        check_variables(self.linked, self._prefix(), self.diagnostics)
        inputs_lines, outputs_lines = self._port_lines(roots)
        ports = [self._ports("input", inputs_lines), self._ports("output", outputs_lines)]
        for group in ports:
            check_identifiers(group, self.diagnostics)
        if step is None or self.diagnostics.error_count > before:
            return None
        settings = self._settings(roots)
        if settings is None:
            return None
        token_parameters = self.metadata.tokens.names("PARAMETER") if self.metadata.tokens else []
        listed = [name for code in self.linked.units for name, _ in listed_names(code.file, "parameter")]
        parameters, places = make_parameters(settings, listed or token_parameters, ())
        model = Model(
            name=self._name(),
            origin="20-sim C function",
            language="c",
            **self.common(ports),
            method=method,
            step=step,
            parameters=parameters,
            rounded=rounded,
            code=self._details(
                initialize,
                self._elements(inputs_lines),
                self._elements(outputs_lines),
                self.places(places),
            ),
        )
        return model if self.agrees(model, self._prefix()) else None

    def _ports(self, kind: str, lines: list[PortLine]) -> tuple[Port, ...]:
        """The ports of ``kind`` "input" or "output".  Their names come from the sources, else from the tokens."""
        names = listed_names(self.file, kind)
        token_names = self.metadata.tokens.names(kind.upper()) if self.metadata.tokens else []
        if len(names) != len(lines) and len(token_names) == len(lines):
            names = [(name, self.whole) for name in token_names]
        expected = self._stated_count(f"number_of_{kind}s")
        return make_ports(lines, kind, names, self.metadata.configuration, self.diagnostics, self.whole, expected)

    def _settings(self, roots: list[Function]) -> list[ArrayAssignment] | None:
        """The lines that set parameters.  None, after an error, if no file defines the array."""
        array = self._array("P")
        settings = [
            line
            for code, function in self.linked.reachable(roots)
            for line in assignments(code.file, function.body_start, function.body_end)
            if line.array in (array, f"model_instance->{array}")
        ]
        if settings and not self._exists(array):
            message = f"'{settings[0].array}' is set, but no file of the export defines it"
            hint = "check that all files are there and renamed in the same way, or export the model again"
            self.diagnostics.error("model-incomplete", settings[0].span, message, hint=hint)
            return None
        return settings

    def _elements(self, lines: list[PortLine]) -> tuple[PortElement, ...]:
        """The array element of each port, for an export without vectors of inputs and outputs; else empty."""
        if not self._vectorless():
            return ()
        ordered = sorted(lines, key=lambda line: line.index)
        return tuple(PortElement(self._member(line.array), line.array_index) for line in ordered)

    def _details(
        self,
        initialize: Function | None,
        inputs: tuple[PortElement, ...],
        outputs: tuple[PortElement, ...],
        places: tuple[tuple[SourceRange, ...], ...],
    ) -> CFunctionExport:
        """The details of the export that the emitter needs."""
        terminate, static = self.entries.get("Terminate"), self._static()
        header = self._instance_header()
        variables = [variable for _, variable in self.variables.values()]
        names = {name for code in self.linked.units for name in code.global_names()}
        return CFunctionExport(
            linked=self.linked,
            real=base_type("XXDouble", self.types) or "double",
            initialize=self._entry(self.entries["Initialize"]),
            calculate=self._entry(self.entries["Calculate"]),
            terminate=self._entry(terminate) if terminate else EntryPoint("", ()),
            calculate_static=self._entry(static[0]) if static else None,
            model_initialize=self._entry(initialize) if initialize else None,
            inputs=inputs,
            outputs=outputs,
            parameters=self._existing_array("P"),
            states=self._existing_array("s"),
            rates=self._existing_array("R"),
            state_count=self._state_count(),
            pointers=tuple(sorted(name for name, (_, variable) in self.variables.items() if variable.pointer)),
            time=self._variable_name("time"),
            stop=self._variable_name("stop_simulation"),
            variables=() if self.instance_type else global_variables(variables, self.types, self.macros),
            places=places,
            instance_type=self.instance_type,
            instance_header=header.file.path.name if header else "",
            memory=self._memory(),
            declared=header is not None and self.entries["Calculate"].name in header.identifiers,
            renames=tuple(sorted(names - self.linked.macro_names())),
        )

    # names ----------------------------------------------------------------------------------------------------------

    def _name(self) -> str:
        return one_line(self.heading("subm", r"[^\n]*") or self.file.path.parent.name)

    def _step_name(self) -> str:
        """The name of the variable or macro with the step size.  It has the prefix and the suffix of all names."""
        candidates = [name for name in self.variables if "step_size" in name]
        candidates += [macro for macro in self.macros if "step_size" in macro]
        used = self.main.identifiers
        candidates.sort(key=lambda name: (name not in used, name not in self.variables, len(name), name))
        return candidates[0] if candidates else "xx_step_size"

    def _prefix(self) -> str:
        return self._step_name().partition("step_size")[0]

    def _suffix(self) -> str:
        return self._step_name().partition("step_size")[2]

    def _array(self, letter: str) -> str:
        """The name of an array.  Some users add their suffix to the names of arrays only."""
        names = [f"{self._prefix()}{letter}{suffix}" for suffix in (self._suffix(), *self._array_suffixes(), "")]
        return next((name for name in names if self._exists(name)), names[0])

    def _existing_array(self, letter: str) -> str:
        """The same; empty if there is no such array."""
        name = self._array(letter)
        return name if self._exists(name) else ""

    def _array_suffixes(self) -> list[str]:
        pattern = re.compile(rf"{re.escape(self._prefix())}[VR](\w+)")
        matches = [pattern.fullmatch(name) for name, (_, v) in sorted(self.variables.items()) if v.dimensions]
        return [match[1] for match in matches if match]

    def _exists(self, name: str) -> bool:
        return name in self.variables or name in self.macros

    def _variable_name(self, word: str) -> str:
        names = (f"{self._prefix()}{word}{self._suffix()}", f"{self._prefix()}{word}", f"xx_{word}")
        return next((name for name in names if name in self.variables), "")

    # entry points ---------------------------------------------------------------------------------------------------

    def _instance_type(self) -> str:
        """The typedef of the model's memory, which Calculate takes by a pointer; empty for global variables."""
        parameters = self.entries["Calculate"].parameters
        match = re.match(r"(?:struct\s+)?(\w*ModelInstance\w*)\s*\*", parameters, re.ASCII)
        return match[1] if match else ""

    def _entry(self, function: Function) -> EntryPoint:
        """The function as an entry point.

        The meaning of each argument is derived from its type, and from its use in the body of the function.
        """
        body = self.main.body(function) if function in self.main.functions else ""
        arguments: list[str] = []
        for parameter in parameters_of(function):
            if parameter.strip() in ("", "void"):
                continue
            name = (re.sub(r"\[.*", "", parameter).split("*")[-1].split() or [""])[-1]
            if self.instance_type and self.instance_type in parameter:
                arguments.append("instance")
            elif "*" in parameter or "[" in parameter:
                arguments.append(_vector(name, body, arguments))
            elif "time" in arguments or "step" in arguments:
                arguments.append("next_time")
            else:
                sets_step = re.search(rf"\b{re.escape(self._step_name())}\s*=\s*{re.escape(name)}\s*;", body)
                arguments.append("step" if sets_step else "time")
        return EntryPoint(function.name, tuple(arguments), base_type(function.result, self.types) or "void")

    def _instance_header(self) -> CFile | None:
        """The header that declares the type of the model's memory, if it has one."""
        declaration = re.compile(rf"\}}\s{{0,80}}{self.instance_type}\s*;")
        headers = self.linked.headers if self.instance_type else ()
        return next((code for code in headers if declaration.search(code.file.code)), None)

    def _member(self, array: str) -> str:
        """The member of the instance for an array: ``V`` for ``xx_V``, which is a macro for ``model_instance->V``."""
        return re.sub(r".*->\s*", "", self.macros.get(array, array)) if self.instance_type else array

    def _memory(self) -> tuple[tuple[str, str], ...]:
        """The pointers of the instance, each with its offset in MEMORY, in the order that the FMI functions use."""
        if not self.instance_type:
            return ()
        text = "".join(code.file.code for code in self.linked.headers)
        pointers = set(re.findall(r"(?<!\w)\w{1,255}\s{0,80}\*\s{0,80}([CPIVsR])\s{0,80};", text))
        counts: list[str] = []
        result: list[tuple[str, str]] = []
        for letter, word in zip("CPIVsR", _MEMORY_COUNTS, strict=True):
            macro = next((name for name in sorted(self.macros) if re.fullmatch(rf"\w*?(?<![a-z]){word}\w*", name)), "")
            if letter in pointers:
                result.append((letter, " + ".join(counts) or "0"))
                counts.append(macro or "0")
        return tuple(result)

    def _static(self) -> list[Function]:
        """The function for the static equations, if Initialize calls one: a list with at most one function."""
        called = {name for name, _ in self.main.calls(self.entries["Initialize"])}
        return [f for _, f in self.linked.functions() if f.name in called and "CalculateStatic" in f.name][:1]

    def _model_initialize(self) -> Function | None:
        """The function that sets the parameters, if not Initialize but the FMI functions call it.  Else None."""
        initialize = [self.entries["Initialize"]]
        name = re.compile(r"\w*?ModelInitialize(?!_)\w*")
        if any(name.fullmatch(function.name) for _, function in self.linked.reachable(initialize)):
            return None
        functions = [function for _, function in self.linked.functions() if name.fullmatch(function.name)]
        return functions[0] if functions else None

    # values ---------------------------------------------------------------------------------------------------------

    def _scalar_place(self, word: str) -> tuple[Span, str] | None:
        """The place and the text of the initial value of the variable ``<prefix><word><suffix>``.

        If it has none, the value that the FMI functions set.
        """
        name = self._variable_name(word)
        if name:
            code, variable = self.variables[name]
            if variable.initializer:
                return code.file.span(variable.start, variable.start + len(name)), variable.initializer
        for file in [code.file for code in self.linked.units] + self._fmi_files():
            for match in _SCALAR.finditer(file.code):
                if word in match[1] and exact_number(match[2]) is not None:
                    return file.span(match.start(), match.end()), match[2]
        return None

    def _fmi_files(self) -> list[SourceFile]:
        """The files with FMI functions beside the model, which are not linked, but set some of its values."""
        paths = [p for p in source_files(self.file.path.parent, SUFFIXES, 0) if p.name.lower().startswith("fmi")]
        files = [read_source(path, Diagnostics()) for path in paths]
        return [file for file in files if file is not None]

    def _step(self) -> Fraction | None:
        hint = f"the sources must set it, for example '{self._step_name()} = 0.001;'"
        return self.checked_step(self._scalar_place("step_size"), hint)

    def _stated_count(self, word: str) -> int | None:
        for name, (_, variable) in sorted(self.variables.items()):
            if word in name:
                return integer_value(variable.initializer, self.macros)
        return None

    def _method(self) -> tuple[str, CFile, int]:
        for name, start in self.main.calls(self.entries["Calculate"]):
            if "Step" in name:
                match = _METHODS.search(name)
                return match[1] if match else name.partition("Step")[0].removeprefix("XX"), self.main, start
        for code in self.linked.all:
            for macro in code.macros:
                if macro.name.endswith("_METHOD"):
                    return macro.name.removesuffix("_METHOD"), code, macro.start
        return "", self.main, self.entries["Calculate"].start

    def _state_count(self) -> int:
        """The number of continuous or discrete states, from the size of their array, else from macros or the tokens."""
        variable = self.variables.get(self._array("s"))
        if variable and variable[1].dimensions:
            return integer_value(variable[1].dimensions.strip("[] "), self.macros) or 0
        for name in ("STATE_SIZE", "state_count", "states_size"):
            for macro, value in sorted(self.macros.items()):
                if name in macro and "dep" not in macro:
                    return integer_value(value, self.macros) or 0
        return self.metadata.tokens.count("NUMBER_STATES") if self.metadata.tokens else 0

    # ports ----------------------------------------------------------------------------------------------------------

    def _vectorless(self) -> bool:
        """True if the entry points do not take the vectors ``u`` and ``y``, as in sources of an FMU."""
        return not {"u", "y"} & {a for f in self.entries.values() for a in self._entry(f).arguments}

    def _port_lines(self, roots: Iterable[Function]) -> tuple[list[PortLine], list[PortLine]]:
        """The lines that connect inputs and outputs with the model.  Without vectors, they are in the metadata."""
        if self._vectorless():
            lines = self.metadata.port_elements(self._fmi_array())
            if lines is None:
                message = "these are the C sources of an FMU, but there is no file with the names of its ports"
                hint = "copy tokens.xml, ModelConfiguration.xml or modelDescription.xml into the folder"
                self.diagnostics.error("model-ports", self.whole, message, hint=hint)
            return lines or ([], [])
        reachable = self.linked.reachable(roots)
        return self.port_lines(reachable, "input"), self.port_lines(reachable, "output")

    def _fmi_array(self) -> str:
        """The name of the array in which a value reference is an index."""
        return (
            "MEMORY" if self.instance_type else next((n for n in self.variables if n.endswith("MEMORY")), "xx_MEMORY")
        )


def _vector(name: str, body: str, known: list[str]) -> str:
    """The meaning, "u" or "y", of a vector ``name`` that is an argument behind the ``known`` ones.

    The ``body`` of the function gives the vector of outputs to a function with "Output" in its name.
    """
    call = rf"(?<!\w)(\w{{1,255}})\s{{0,80}}\(\s{{0,80}}{re.escape(name)}\s{{0,80}}\)"
    calls = re.finditer(call, body) if name else ()  # C23 permits a parameter without a name
    is_output = any("Output" in match[1] for match in calls) or name.startswith("y")
    if is_output and "y" not in known:
        return "y"
    return "y" if "u" in known else "u"
