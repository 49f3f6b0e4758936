# SPDX-License-Identifier: Apache-2.0
"""Allocations for configurations that are written as text, for tests."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from epg.generator.catalog.catalog import load_catalog
from epg.generator.check.configuration import check_configuration
from epg.generator.data import targets_roots
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.tcf import load_tcf_chain
from epg.generator.resolve.allocation import Assignment, allocate
from epg.generator.resolve.claims import ClaimKey, component_claims, tick_claims


@dataclass(frozen=True)
class Outcome:
    """The allocated hardware of a ``.tcf``."""

    assignments: Mapping[ClaimKey, Assignment] | None
    problems: Diagnostics

    @property
    def ids(self) -> list[str]:
        return [problem.id for problem in self.problems]

    def resources(self) -> dict[str, str]:
        """The assignment of each claim in words: ``{"encoder_pan.encoder": "PIO block 0, state machine 0"}``."""
        assert self.assignments is not None, [problem.message for problem in self.problems]
        return {f"{owner}.{claim}".strip("."): found.resource for (owner, claim), found in self.assignments.items()}


def allocate_file(name: str, user_roots: Sequence[Path] = (), beside: Path | None = None) -> Outcome:
    """The hardware of a ``.tcf`` that is found by ``name``."""
    problems = Diagnostics()
    roots = targets_roots(user_roots)
    catalog = load_catalog(roots, problems)
    chain = load_tcf_chain(name, roots, problems, beside=beside)
    configuration = check_configuration(chain, [], catalog, problems) if chain else None
    if configuration is None:
        return Outcome(None, problems)
    period = configuration.control.period
    claims = [
        *component_claims(configuration),
        *tick_claims(configuration.target, period, configuration.control.period_span),
    ]
    return Outcome(allocate(claims, configuration.target, problems), problems)


def allocate_components(
    folder: Path,
    target: str,
    components: Sequence[str],
    *,
    period: Fraction | str = "1 ms",
    user_roots: Sequence[Path] = (),
    middleware: str = "",
) -> Outcome:
    """The hardware of components that are written as in a ``.tcf``: ``"p: {kind: pwm, pins: {value: 3}}"``."""
    written = period if isinstance(period, str) else f"{period.numerator / period.denominator!r} s"
    lines = [
        "version: 1",
        f"target: {target}",
        "node: robot",
        f"control: {{period: {written}, enable_at_start: false}}",
    ]
    lines += [f"communication: {{middleware: {middleware}}}"] if middleware else []
    lines += ["components:", *(f"  {component}" for component in components)]
    path = folder / "robot.tcf"
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return allocate_file(path.name, user_roots, folder)


if __name__ == "__main__":
    folder, user_root, *names = sys.argv[1:]
    for name in names:
        print(allocate_file(name, [Path(user_root)], Path(folder)).resources())
