# SPDX-License-Identifier: Apache-2.0
"""Exports of 20-sim's C++ class target."""

from __future__ import annotations

import re
from functools import partial

from epg.generator.importers.cpp_class import cpp_class
from epg.generator.importers.importer import FoundModel
from epg.generator.importers.submodel_sources import SubmodelSources
from epg.generator.models.c_code import CFile


class CppClass(SubmodelSources):
    """A source file with the class of a submodel, under any name."""

    suffixes = cpp_class.SUFFIXES
    part = re.compile("::CopyInputsToVariables")

    def found(self, code: CFile) -> FoundModel | None:
        if not cpp_class.submodel_classes(code):
            return None
        return FoundModel(code.file.path, partial(cpp_class.load_cpp_class, code))


IMPORTER = CppClass()
