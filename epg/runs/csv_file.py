# SPDX-License-Identifier: Apache-2.0
"""The one writer of the CSV files that hold recordings; :mod:`epg.runs.recording` reads them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from epg.runs.recording import BEGIN, Row


class CsvFile:
    """A CSV file that is being written: a column of times in seconds, and the columns ``names``.

    ``time`` and ``value`` are their forms: ``%s`` writes as few digits as a number needs to be read as the same double
    again, and texts as they are.  ``facts`` about a target are in a line of their own.

    >>> # file = CsvFile(Path("run.csv"), ["position", "duty"])
    >>> # file.write([Row(0.0, [0.25, 1.0])]); file.close()
    """

    def __init__(
        self,
        path: Path,
        names: Sequence[str],
        time: str = "%.6f",
        value: str = "%.9g",
        facts: Mapping[str, Any] | None = None,
    ) -> None:
        self._form = ",".join([time, *[value] * len(names)]) + "\n"
        self._file = path.open("w", encoding="utf-8", newline="\n")
        begin = "" if facts is None else f"{BEGIN}{json.dumps(facts)}\n"
        self._file.write(f"{begin}{','.join(('time', *names))}\n")

    def write(self, rows: Iterable[Row]) -> None:
        form = self._form
        self._file.writelines(form % (row.time, *row.values) for row in rows)

    def flush(self) -> None:
        self._file.flush()

    def close(self) -> None:
        self._file.close()

    def __enter__(self) -> CsvFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
