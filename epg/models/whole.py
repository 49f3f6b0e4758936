# SPDX-License-Identifier: Apache-2.0
"""Sources that are not whole: cut off by a copy that failed, or with the marks of an unfinished merge."""

from __future__ import annotations

import re

from epg.diagnostics import Diagnostics
from epg.documents.source_file import SourceFile

_MARK = re.compile(r"^(?:<{7} |={7}$|>{7} )", re.MULTILINE)
_OTHER_BRANCH = re.compile(r"^[ \t]*#[ \t]*(?:else|elif)", re.MULTILINE)


def is_whole(file: SourceFile, diagnostics: Diagnostics) -> bool:
    """Reports a file that ends inside of braces, or that git has left with both versions of a line."""
    name = file.path.name
    mark = _MARK.search(file.text)
    if mark:
        message = f"'{name}' has the marks of a merge that was not finished"
        hint = "take one of the two versions that stand between the marks, or export again"
        diagnostics.error("model-incomplete", file.span(mark.start(), mark.end()), message, hint=hint)
        return False
    # branches of the preprocessor may open a brace each, of which one is closed
    if file.code.count("{") > file.code.count("}") and not _OTHER_BRANCH.search(file.without_comments):
        end = len(file.text.rstrip())
        message = f"'{name}' ends where a '}}' is still missing: the file is cut off"
        hint = "copy the whole file, or export again"
        diagnostics.error("model-incomplete", file.span(max(end - 1, 0), end), message, hint=hint)
        return False
    return True
