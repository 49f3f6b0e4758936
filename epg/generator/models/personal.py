# SPDX-License-Identifier: Apache-2.0
"""Removes personal data from the ``ModelConfiguration.xml`` of 20-sim.

Its ``<general>`` contains the full path of the model file, the folder, the license and the person to whom it is
registered.  EPG does not need these data, and a user who publishes the export need not publish them.
"""

from __future__ import annotations

import re

_GENERAL = re.compile(rb"<general>.*?</general>", re.DOTALL)
_ABOUT_PEOPLE = re.compile(
    rb"[ \t]*<(modelDir|originalModel|additional|creationDate|author|company)>.*?</\1>[ \t]*\r?\n?", re.DOTALL
)


def without_personal_data(configuration: bytes) -> bytes:
    """A ``ModelConfiguration.xml`` without personal data: folder, model file, license, author, company and date.

    All other bytes stay the same.

    >>> without_personal_data(b"<general><name>Pan</name><additional>A. Person</additional></general>")
    b'<general><name>Pan</name></general>'
    """
    return _GENERAL.sub(lambda general: _ABOUT_PEOPLE.sub(b"", general[0]), configuration, count=1)
