# SPDX-License-Identifier: Apache-2.0
"""The search against brute force, for problems on which a greedy choice fails, and its speed."""

from __future__ import annotations

import itertools
import random
import sys
from collections.abc import Iterator, Sequence
from types import FrameType

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from epg.generator.resolve.search import WHOLE, Demand, Place, _Problem, _Use, find_places


def fits(demands: Sequence[Demand], places: Sequence[Place]) -> bool:
    """True if there is one place per demand, and no two users disturb each other: the definition of a solution."""
    if any(place not in demand.places for demand, place in zip(demands, places)):
        return False
    for (one, (instance, slot)), (other, (instance2, slot2)) in itertools.combinations(zip(demands, places), 2):
        if instance == instance2 and (slot == slot2 or WHOLE in (slot, slot2) or one.agree != other.agree):
            return False
    return True


def brute_force(demands: Sequence[Demand]) -> bool:
    """True if any choice of places fits; tries each choice, depth first."""

    def extend(chosen: list[Place]) -> bool:
        if len(chosen) == len(demands):
            return True
        return any(
            fits(demands[: len(chosen) + 1], [*chosen, place]) and extend([*chosen, place])
            for place in sorted(demands[len(chosen)].places)
        )

    return extend([])


def greedy(demands: Sequence[Demand]) -> bool:
    """True if it works to take the first free place for one demand after another."""
    chosen: list[Place] = []
    for number, demand in enumerate(demands):
        free = [p for p in sorted(demand.places) if fits(demands[: number + 1], [*chosen, p])]
        if not free:
            return False
        chosen.append(free[0])
    return True


@st.composite
def problems(draw: st.DrawFn) -> list[Demand]:
    """Small peripherals on which demands take any combination of slots, or whole instances."""
    instances, slots = draw(st.integers(1, 4)), draw(st.integers(1, 3))
    single = st.tuples(st.integers(0, instances - 1), st.integers(0, slots - 1))
    whole = st.tuples(st.integers(0, instances - 1), st.just(WHOLE))
    demand = st.builds(
        Demand,
        places=st.one_of(
            st.frozensets(single, min_size=1),
            st.frozensets(whole, min_size=1),
            st.just(frozenset(itertools.product(range(instances), range(slots)))),
        ),
        agree=st.integers(0, 2),
    )
    return draw(st.lists(demand, max_size=7))


@settings(max_examples=500, deadline=None)
@given(problems())
@example([Demand(frozenset({(0, 0), (1, 0)})), Demand(frozenset({(0, WHOLE)}))])
def test_it_finds_a_way_exactly_when_there_is_one(demands: list[Demand]) -> None:
    found = find_places(demands)
    assert (found is not None) == brute_force(demands)
    assert found is None or fits(demands, found)


@settings(max_examples=100, deadline=None)
@given(problems(), st.randoms(use_true_random=False))
def test_the_order_of_demands_does_not_decide(demands: list[Demand], order: random.Random) -> None:
    shuffled = list(demands)
    order.shuffle(shuffled)
    assert (find_places(shuffled) is None) == (find_places(demands) is None)


@settings(max_examples=300, deadline=None)
@given(problems())
def test_a_dive_that_gets_through_finds_what_the_search_finds(demands: list[Demand]) -> None:
    problem = _Problem(demands, ())
    begin = (
        tuple(len(group.members) for group in problem.groups),
        tuple(_Use((0,) * len(instance.banks), -1) for instance in problem.instances),
    )
    dive = problem._dive(begin)
    assert dive is None or dive == problem._search(begin)


def test_five_hundred_motors_are_placed_in_few_steps() -> None:
    """Each has one place and agrees with its neighbour; a timer needs a whole slice: 800,000 calls, half a second."""
    motors = [Demand(frozenset({(number // 2, number % 2)}), "20 kHz") for number in range(500)]
    timer = Demand(frozenset((instance, WHOLE) for instance in range(251)))
    found, steps = search([*motors, timer])
    assert found is not None and found[-1] == (250, WHOLE)
    assert steps < 1_600_000


def test_what_a_greedy_choice_refuses_is_accepted() -> None:
    """A timer with a choice of two, then a timer with only one: taking the first free one fails."""
    demands = [Demand(frozenset({(0, 0), (1, 0)})), Demand(frozenset({(0, 0)}))]
    assert not greedy(demands)
    assert find_places(demands) == ((1, 0), (0, 0))


def test_agreeing_users_share_an_instance_although_another_is_free() -> None:
    """Three programs on two blocks fit only if both users of the same program take the same block."""
    anywhere = frozenset(itertools.product(range(2), range(2)))
    demands = [Demand(anywhere, "x"), Demand(anywhere, "y"), Demand(anywhere, "x"), Demand(anywhere, "y")]
    found = find_places(demands)
    assert found is not None and fits(demands, found)
    assert found[0][0] == found[2][0] != found[1][0]


def test_the_cheapest_of_equal_instances_is_taken() -> None:
    anywhere = Demand(frozenset((instance, WHOLE) for instance in range(4)))
    assert find_places([anywhere], [4, 2, 0, 4]) == ((2, WHOLE),)


def test_hundreds_of_demands_do_not_end_the_recursion() -> None:
    anywhere = frozenset((0, slot) for slot in range(256))
    assert find_places([Demand(anywhere)] * 256) == tuple((0, slot) for slot in range(256))
    assert find_places([Demand(anywhere)] * 257) is None


def hard_problems() -> Iterator[tuple[str, list[Demand]]]:
    """30 claims of which one cannot be satisfied, in the ways for which a plain search takes the longest."""
    everywhere = frozenset(itertools.product(range(7), range(4)))
    yield "one too many, all equal", [Demand(everywhere)] * 29 + [Demand(frozenset({(0, 0)}))]
    blocks = frozenset(itertools.product(range(8), range(4)))
    yield "nine programs for eight blocks", [Demand(blocks, number % 9) for number in range(30)]
    yield "ten groups of three with a full block each", [Demand(blocks, number // 3) for number in range(30)]
    wholes = frozenset((instance, WHOLE) for instance in range(15))
    slots = frozenset(itertools.product(range(15), range(2)))
    yield "whole instances and slots", [Demand(wholes)] * 5 + [Demand(slots)] * 21 + [Demand(slots, 1)] * 4
    halves = [frozenset((i, s) for i in range(15) if i % 2 == odd for s in range(2)) for odd in (0, 1)]
    yield "two halves", [Demand(halves[1])] * 15 + [Demand(halves[0], number) for number in range(15)]
    pairs = [frozenset({(i, 0), (i, 1), ((i + 1) % 10, 0), ((i + 1) % 10, 1)}) for i in range(10)]
    yield "a ring of pairs", [Demand(pairs[number % 10], number // 10) for number in range(30)]


@pytest.mark.parametrize("demands", [p for _, p in hard_problems()], ids=[name for name, _ in hard_problems()])
def test_refusing_thirty_claims_takes_few_steps(demands: list[Demand]) -> None:
    assert len(demands) == 30
    found, steps = search(demands)
    assert found is None
    assert steps < 5_000


def search(demands: Sequence[Demand]) -> tuple[tuple[Place, ...] | None, int]:
    """The result of a search, and its number of function calls, which is the same on every computer, unlike time."""
    steps = 0

    def count(frame: FrameType, event: str, argument: object) -> None:
        nonlocal steps
        steps += event in ("call", "c_call")

    sys.setprofile(count)
    try:
        found = find_places(demands)
    finally:
        sys.setprofile(None)
    return found, steps
