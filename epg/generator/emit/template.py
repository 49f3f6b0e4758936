# SPDX-License-Identifier: Apache-2.0
"""Jinja templates that refuse to print text without escaping it.

Jinja's ``autoescape`` knows HTML only, and trusts every text that a template marks as safe.  Here, the output language
decides: ``finalize`` refuses each value that no filter has made code of this language, and :class:`_Environment`
refuses templates with operations that join or mark text.  A convention for authors would not be enough.  Templates of
kinds and platforms are also written by users, and one forgotten filter would let a text of a ``.tcf`` become C.

>>> # env = environment([folder])
>>> # env.from_string("{{ name|identifier }} = {{ value|double }};").render(name="gain", value=0.5)
"""

from __future__ import annotations

import hashlib
import math
import os
import re
import sys
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import jinja2
from jinja2 import compiler, nodes
from jinja2.runtime import Macro

from epg.generator.bootstrap import cache_folder
from epg.generator.catalog.kind import TEMPLATE
from epg.generator.diagnostics import Diagnostics, UserError
from epg.generator.emit import text
from epg.generator.emit.text import CMakeCode, Code, DevicetreeCode, Escaped, KconfigCode, ProjectText
from epg.generator.source import Span

FILTERS: Mapping[type[Escaped], Mapping[str, Callable[..., object]]] = {
    Code: {
        "cstring": text.cstring,
        "comment": text.comment,
        "identifier": text.identifier,
        "include": text.include,
        "double": text.double,
        "bool": text.boolean,
        "ns": text.nanoseconds,
        "code": Code,
    },
    CMakeCode: {"string": text.cmake, "word": lambda value: CMakeCode(text.word(value)), "code": CMakeCode},
    DevicetreeCode: {
        "string": text.devicetree_string,
        "comment": lambda value: DevicetreeCode(text.comment(value)),
        "label": lambda value: DevicetreeCode(text.identifier(value)),
        "node": lambda value: DevicetreeCode(str(text.identifier(value)).replace("_", "-")),
        "code": DevicetreeCode,
    },
    KconfigCode: {
        "string": text.kconfig_string,
        "bool": text.kconfig_bool,
        "symbol": text.kconfig_symbol,
        "comment": lambda value: KconfigCode(text.comment(value)),
        "code": KconfigCode,
    },
    ProjectText: {
        "cmake": lambda value: ProjectText(text.cmake(value)),
        "identifier": lambda value: ProjectText(text.identifier(value)),
        "line": text.line,
        "word": text.word,
        "code": ProjectText,
    },
}
"""The filters of each output language, which make code of values.  ``code`` accepts only constants of the template."""

_PLAIN_FILTERS = """abs count default first float int last length list lower map max min reject rejectattr reverse round
select selectattr sort sum unique upper""".split()
"""Filters of Jinja that do not change whether text is escaped: their result is escaped exactly if their input is."""


def environment(folders: Iterable[Path], language: type[Escaped] = Code) -> jinja2.Environment:
    """A Jinja environment for one output language.  Undefined names and text without a filter are errors."""

    def only_code(value: object) -> object:
        if isinstance(value, language) or type(value) is int:
            return value
        raise TypeError(f"a template printed {value!r} ({type(value).__name__}) without a filter")

    env = _Environment(
        loader=_Loader([str(folder) for folder in folders]),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        finalize=only_code,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        extensions=["jinja2.ext.do"],
        bytecode_cache=_compiled(language),
    )
    env.language = language
    plain = {name: env.filters[name] for name in _PLAIN_FILTERS}
    env.filters.clear()
    env.filters.update(plain)
    env.filters.update(FILTERS[language])
    env.globals["pi"] = math.pi
    return env


def _compiled(language: type[Escaped]) -> jinja2.BytecodeCache | None:
    """A cache of compiled templates in EPG's cache folder, or None if the folder cannot be written.

    Without a cache, compiling templates takes two fifths of the time of a run.  Jinja detects only a change of a
    template's text.  The name of the folder therefore depends on everything else that affects the compiled code: the
    language, and the code of Jinja and of this package.
    """
    own = hashlib.sha256(language.__name__.encode())
    for module in (compiler.__file__, text.__file__, __file__):
        own.update(Path(str(module)).read_bytes())
    folder = cache_folder() / f"templates-{sys.implementation.cache_tag}-{own.hexdigest()[:12]}"
    try:
        folder.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        folder.mkdir(exist_ok=True)
    except OSError:
        return None
    writable = os.access(folder, os.W_OK) and not sys.dont_write_bytecode
    return jinja2.FileSystemBytecodeCache(str(folder)) if writable else None


class _Loader(jinja2.FileSystemLoader):
    """Loads templates.  For a template that is not UTF-8, the error has the line of the first wrong byte."""

    def get_source(self, environment: jinja2.Environment, template: str) -> tuple[str, str, Callable[[], bool]]:
        try:
            return super().get_source(environment, template)
        except UnicodeDecodeError as error:
            line = error.object[: error.start].count(b"\n") + 1
            path = next(Path(root) / template for root in self.searchpath if (Path(root) / template).is_file())
            raise jinja2.TemplateSyntaxError(NOT_UTF_8, line, template, str(path)) from None


NOT_UTF_8 = "it is not UTF-8 text"


class CodeMacro(Macro):
    """A macro whose result is code in the language of its environment."""

    def _invoke(self, arguments: list[Any], autoescape: bool) -> Escaped:
        environment = self._environment
        assert isinstance(environment, _Environment)
        return environment.language(super()._invoke(arguments, autoescape))


class _CodeGenerator(compiler.CodeGenerator):
    """Compiles templates so that macros and blocks return code of the language instead of HTML (``Markup``)."""

    def visit_Template(self, node: nodes.Template, frame: Any = None) -> None:
        super().visit_Template(node, frame)
        environment = self.environment
        assert isinstance(environment, _Environment)
        self.writeline(f"from epg.generator.emit.text import {environment.language.__name__} as Markup")
        self.writeline("from epg.generator.emit.template import CodeMacro as Macro")


class _Environment(jinja2.Environment):
    """Refuses expressions that avoid the filters, with the line of the template on which they are written."""

    code_generator_class = _CodeGenerator
    language: type[Escaped]

    def _parse(self, source: str, name: str | None, filename: str | None) -> nodes.Template:
        tree = super()._parse(source, name, filename)
        for node in tree.find_all((nodes.Concat, nodes.Filter, nodes.ScopedEvalContextModifier)):
            problem = _problem(node)
            if problem:
                raise jinja2.TemplateAssertionError(problem, node.lineno, name, filename)
        return tree


def _problem(node: nodes.Node) -> str:
    """The reason why a template must not contain ``node``; empty if it can."""
    if isinstance(node, nodes.Concat):
        return "'~' joins text without a filter: print the parts one after the other"
    if isinstance(node, nodes.ScopedEvalContextModifier):
        return "autoescape cannot be changed"
    if isinstance(node, nodes.Filter) and node.name == "code" and not _is_constant(node.node):
        return "'|code' is for constants: use a filter for the kind of value, such as |identifier or |cstring"
    return ""


def _is_constant(node: nodes.Node | None) -> bool:
    if isinstance(node, nodes.CondExpr):
        return _is_constant(node.expr1) and (node.expr2 is None or _is_constant(node.expr2))
    return isinstance(node, nodes.Const)


def mistake_in_template(error: Exception) -> tuple[str, int, str] | None:
    """The file, the line and the message of an error in a template.  None if no template caused the error."""
    if isinstance(error, jinja2.TemplateSyntaxError):
        file = error.filename or error.name  # for a comment without an end, Jinja has the file in the name
        return (file, error.lineno, error.message or "") if file else None
    place = None
    trace = error.__traceback__
    while trace is not None:
        template = trace.tb_frame.f_globals.get("__jinja_template__")
        # If Python called a macro, the line is that of the compiled code.  Otherwise Jinja has already rewritten the
        # traceback with the lines of the template.
        if template is not None and template.filename:
            place = template.filename, template.get_corresponding_lineno(trace.tb_lineno)
        elif trace.tb_frame.f_code.co_filename.endswith(".j2"):
            place = trace.tb_frame.f_code.co_filename, trace.tb_lineno
        trace = trace.tb_next
    return (*place, str(error)) if place else None


def macro_mistake(folder: Path, macro: str, message: str, arguments: int) -> UserError:
    """The error for a mistake in ``macro`` of the kind in ``folder``.

    ``arguments`` is the number of arguments with which EPG calls the macro.
    """
    form = f"{{% macro {macro}({', '.join(('c', 'port', 'value')[:arguments])}) %}}"
    problems = Diagnostics()
    hint = f"write '{form}'; docs/architecture.md lists all macros"
    problems.error("template-wrong", macro_span(folder, macro), message, hint=hint)
    return UserError(problems)


def macro_span(folder: Path, macro: str) -> Span:
    """The line of ``macro`` in the template of the kind in ``folder``; the first line if it has no such macro."""
    path = folder / TEMPLATE
    lines = path.read_text(encoding="utf-8").splitlines()
    numbers = [number for number, line in enumerate(lines, 1) if re.search(rf"\bmacro\s+{macro}\b", line)]
    return Span(str(path), numbers[0] if numbers else 1, 1)


def unused_macros(env: jinja2.Environment, template: str, macros: Iterable[str]) -> list[str]:
    """Those of ``macros`` whose names ``template`` itself does not use."""
    assert env.loader is not None
    tree = env.parse(env.loader.get_source(env, template)[0])
    used = {node.name for node in tree.find_all(nodes.Name) if node.ctx == "load"}
    return sorted(set(macros) - used)
