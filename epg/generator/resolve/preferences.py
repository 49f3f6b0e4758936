# SPDX-License-Identifier: Apache-2.0
"""Better places for claims that have a choice, after the search has found places for all claims of a peripheral.

These are wishes and not conditions: a wiring that cannot fulfil them is still correct.  As conditions of the search
they would refuse it, and a search for the best of all wirings would have to try them all.  Therefore one claim after
another is restricted to its better places, and keeps them if the search then still finds places for all claims.

- A claim of a class that is ``widest`` gets an instance with the most bits that its pins and the other claims leave.
- The timer of the control loop gets an instance that can trigger the most instances that start together with it.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import replace

from epg.generator.catalog.hardware import Peripheral, ResourceClass
from epg.generator.resolve.search import Demand, Place, find_places


def widest_places(
    demands: Sequence[Demand],
    classes: Sequence[ResourceClass],
    places: tuple[Place, ...],
    peripheral: Peripheral,
    costs: Sequence[int],
) -> tuple[Place, ...]:
    """Places for ``demands``, whose ``classes`` have the same order; ``places`` are possible places."""
    demands = list(demands)
    for number, demand in enumerate(demands):
        most = max(peripheral.bits[instance] for instance, _ in demand.places)
        if not classes[number].widest or peripheral.bits[places[number][0]] == most:
            continue
        wide = frozenset(place for place in demand.places if peripheral.bits[place[0]] == most)
        narrowed = [*demands[:number], replace(demand, places=wide), *demands[number + 1 :]]
        better = find_places(narrowed, costs)
        if better is not None:
            demands, places = narrowed, better
    return places


def triggering_place(
    demand: Demand,
    found: Place,
    taken: Collection[int],
    started: Collection[int],
    peripheral: Peripheral,
    costs: Sequence[int],
) -> Place:
    """The place of the timer of the control loop, for which ``found`` is possible.

    ``taken`` are the instances of other claims; ``started`` are those of them that start together with the timer.
    """
    free = [place for place in demand.places if place[0] not in taken]
    links = {place: sum(place[0] in peripheral.triggered_by.get(other, ()) for other in started) for place in free}
    best = min(free, key=lambda place: (-links[place], costs[place[0]], place), default=found)
    return best if links.get(best, 0) > links.get(found, 0) else found


def start_of(instance: int, tick: int | None, peripheral: Peripheral, otherwise: str) -> str:
    """The way in which ``instance`` starts together with ``tick``, the instance of the timer of the control loop."""
    if tick is not None and tick in peripheral.triggered_by.get(instance, ()):
        return f"started by {peripheral.instances[tick]}"
    return otherwise
