# SPDX-License-Identifier: Apache-2.0
"""Detects sources that are not whole: cut off by a failed copy, or with the marks of an unfinished merge."""

from __future__ import annotations

import re

from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.source_file import SourceFile

_MARK = re.compile(r"^(?:<{7} |={7}$|>{7} )", re.MULTILINE)
_OTHER_BRANCH = r"^[ \t]*#[ \t]*(?:else|elif)"


def is_whole(file: SourceFile, diagnostics: Diagnostics) -> bool:
    """True if a file is whole.  Reports a file that ends inside braces, or that has the marks of a merge by git."""
    name = file.path.name
    mark = _MARK.search(file.text)
    if mark:
        message = f"'{name}' has the conflict markers of a merge that was not finished"
        hint = "keep one of the two versions between the markers, or export the model again"
        diagnostics.error("model-incomplete", file.span(mark.start(), mark.end()), message, hint=hint)
        return False
    # With #else, each branch can open a brace, and one closing brace can belong to all of them: do not count braces.
    if file.code.count("{") > file.code.count("}") and not re.search(
        _OTHER_BRANCH, file.without_comments, re.MULTILINE
    ):
        end = len(file.text.rstrip())
        message = f"a '}}' is missing at the end of '{name}': the file is cut off"
        hint = "copy the whole file, or export the model again"
        diagnostics.error("model-incomplete", file.span(max(end - 1, 0), end), message, hint=hint)
        return False
    return True
