# SPDX-License-Identifier: Apache-2.0
"""What 20-sim writes about people and their computers into ``ModelConfiguration.xml``.

Its ``<general>`` names the model file with its whole path, the folder, the license and the person it is registered
to.  EPG reads nothing of it, and whoever publishes the export need not publish that.
"""

from __future__ import annotations

import re

_GENERAL = re.compile(rb"<general>.*?</general>", re.DOTALL)
_ABOUT_PEOPLE = re.compile(
    rb"[ \t]*<(modelDir|originalModel|additional|creationDate|author|company)>.*?</\1>[ \t]*\r?\n?", re.DOTALL
)


def without_personal_data(configuration: bytes) -> bytes:
    """A ``ModelConfiguration.xml`` without the folder, the model file, the license and the date; else byte for byte.

    >>> without_personal_data(b"<general><name>Pan</name><additional>A. Person</additional></general>")
    b'<general><name>Pan</name></general>'
    """
    return _GENERAL.sub(lambda general: _ABOUT_PEOPLE.sub(b"", general[0]), configuration, count=1)
