# SPDX-License-Identifier: Apache-2.0
"""The search for a place for every demand on one peripheral.

The problem: a peripheral has instances, and an instance can have slots.  A demand takes one of its possible places: a
slot of an instance, or the whole instance.  All users of an instance must agree on their attributes.  To give each
demand the first free place would refuse wirings that are possible.  Therefore this is a depth-first search, which
always places a demand of the most constrained group next.

Most wirings need no backtracking.  Before the search, a *dive* makes the best move again and again, without checks of
the remaining demands.  If it places all demands, each of its steps would have passed these checks, so the full search
would find the same places.  If it fails, the full search begins, with checks after each step.

The search must also prove quickly that a wiring is impossible.  Three things make this fast:

- Equal demands are one *group*.  The order of its members does not matter.
- Slots of an instance that are equal for all groups are one *bank*; instances with equal banks have one *profile*.
  Only one of several equal instances is tried.
- The key of a state does not contain names: it is the number of remaining demands of each group, and the number of used
  slots of each bank.  A state that has failed once is remembered by its key and not tried again.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator, Mapping, Sequence

from epg.generator.dataclass import dataclass

WHOLE = -1
"""Used instead of the number of a slot: the whole instance."""

Place = tuple[int, int]
"""Instance and slot, both counted from 0; or instance and :data:`WHOLE`."""


@dataclass(frozen=True)
class Demand:
    """One user: the places that it can have, and the value that all users of its instance must have in common."""

    places: frozenset[Place]
    agree: Hashable = None


@dataclass(frozen=True)
class _Group:
    """Equal demands; ``members`` are their indices in the input.  ``whole``: each takes a whole instance."""

    agree: int
    members: tuple[int, ...]
    whole: bool


@dataclass(frozen=True)
class _Bank:
    """Slots of an instance that the same ``groups`` can use."""

    groups: frozenset[int]
    slots: tuple[int, ...]


@dataclass(frozen=True)
class _Instance:
    """An instance.  Instances with the same ``profile`` are interchangeable as long as they are used equally."""

    index: int
    profile: int
    banks: tuple[_Bank, ...]
    whole: frozenset[int]  # groups that can take the whole instance
    users: frozenset[int]  # groups that can use it
    pressure: int  # number of demands that can use it
    cost: int


@dataclass(frozen=True)
class _Use:
    """The use of an instance: the number of used slots of each bank, and the agreement of its users (-1: no users)."""

    used: tuple[int, ...]
    agree: int


_Move = tuple[int, int, int]  # group, instance (its position in the list), bank or WHOLE
_State = tuple[tuple[int, ...], tuple[_Use, ...]]  # number of remaining demands per group; use of each instance


def find_places(demands: Sequence[Demand], costs: Sequence[int] = ()) -> tuple[Place, ...] | None:
    """A place for each demand, in the order of ``demands``, or None if there are no such places.

    ``costs`` are costs of instances.  Of several instances that are equally good, the cheapest one is taken.
    """
    problem = _Problem(demands, costs)
    moves = problem.solve()
    return None if moves is None else problem.places(moves)


class _Problem:
    """One search: its groups of demands, its instances, and the instances that each group can use."""

    def __init__(self, demands: Sequence[Demand], costs: Sequence[int]) -> None:
        self.count = len(demands)
        self.groups = _groups(demands)
        self.instances = _instances(demands, self.groups, costs)
        self.slots = max((sum(len(bank.slots) for bank in i.banks) for i in self.instances), default=0)
        self.reached: list[list[int]] = [[] for _ in self.groups]  # positions of the instances a group can use
        for position, instance in enumerate(self.instances):
            for number in instance.users:
                self.reached[number].append(position)

    def solve(self) -> list[_Move] | None:
        """The moves that give each demand a place, or None."""
        remaining = tuple(len(group.members) for group in self.groups)
        state: _State = remaining, tuple(_Use((0,) * len(i.banks), -1) for i in self.instances)
        if not self._hopeful(state):
            return None
        return self._dive(state) or self._search(state)

    def _dive(self, state: _State) -> list[_Move] | None:
        """The first path of the search, without checks of the remaining demands; None if it does not place all.

        A move changes only the options of groups that can use its instance.  The options of the others are kept, so
        that a wiring with hundreds of demands stays fast.
        """
        remaining, uses = list(state[0]), list(state[1])
        options = {number: list(self._options(number, uses)) for number, count in enumerate(remaining) if count}
        path: list[_Move] = []
        while options:
            tightest = self._tightest(options, remaining)
            if not options[tightest]:
                return None
            move = min(options[tightest], key=lambda move: self._rank(move, uses))
            path.append(move)
            _, position, _ = move
            uses[position] = self._used(uses[position], move)
            remaining[tightest] -= 1
            if not remaining[tightest]:
                del options[tightest]
            for number in self.instances[position].users:
                if number in options:
                    options[number] = list(self._options(number, uses))
        return path

    def _search(self, state: _State) -> list[_Move] | None:
        """Depth-first search with its own stack, not by recursion: there can be hundreds of demands."""
        refused: set[Hashable] = set()
        path: list[_Move] = []
        stack: list[tuple[_State, Iterator[_Move]]] = [(state, self._moves(state))]
        while stack:
            state, moves = stack[-1]
            if not any(state[0]):
                return path
            for move in moves:
                after = self._after(state, move)
                if self._key(after) not in refused and self._hopeful(after):
                    path.append(move)
                    stack.append((after, self._moves(after)))
                    break
            else:
                refused.add(self._key(state))
                stack.pop()
                if path:
                    path.pop()
        return None

    def places(self, moves: Sequence[_Move]) -> tuple[Place, ...]:
        """The places of all demands after ``moves``.

        Members of a group, slots of a bank and equal instances are used in rising order.
        """
        waiting = [list(group.members) for group in self.groups]
        free = {(n, s): list(bank.slots) for n, i in enumerate(self.instances) for s, bank in enumerate(i.banks)}
        result: list[Place] = [(0, 0)] * self.count
        for group, position, bank in sorted(moves, key=lambda move: (self.instances[move[1]].index, move[2], move[0])):
            slot = WHOLE if bank == WHOLE else free[position, bank].pop(0)
            result[waiting[group].pop(0)] = (self.instances[position].index, slot)
        return tuple(result)

    def _moves(self, state: _State) -> Iterator[_Move]:
        """The possible moves of the most constrained group, the best first."""
        remaining, uses = state
        options = {number: list(self._options(number, uses)) for number, count in enumerate(remaining) if count}
        if not options:
            return iter(())
        tightest = self._tightest(options, remaining)
        return iter(sorted(options[tightest], key=lambda move: self._rank(move, uses)))

    def _tightest(self, options: Mapping[int, Sequence[_Move]], remaining: Sequence[int]) -> int:
        """The group with the fewest options."""
        return min(options, key=lambda number: (len(options[number]), -remaining[number], number))

    def _rank(self, move: _Move, uses: Sequence[_Use]) -> tuple[int, ...]:
        """The order of moves: instances in use first, then those that the fewest demands can use."""
        instance = self.instances[move[1]]
        return int(uses[move[1]].agree < 0), instance.pressure, instance.cost, instance.index, move[2]

    def _options(self, number: int, uses: Sequence[_Use]) -> Iterator[_Move]:
        """The possible moves of a group, with one instance of each set of interchangeable instances."""
        group = self.groups[number]
        seen: set[tuple[int, _Use]] = set()
        for position in self.reached[number]:
            instance, use = self.instances[position], uses[position]
            if (instance.profile, use) in seen or use.agree not in (-1, group.agree):
                continue
            seen.add((instance.profile, use))
            if number in instance.whole and use.agree < 0:
                yield number, position, WHOLE
            for bank, (slots, used) in enumerate(zip(instance.banks, use.used)):
                if number in slots.groups and used < len(slots.slots):
                    yield number, position, bank

    def _after(self, state: _State, move: _Move) -> _State:
        remaining, uses = state
        number, position, _ = move
        left = (*remaining[:number], remaining[number] - 1, *remaining[number + 1 :])
        return left, (*uses[:position], self._used(uses[position], move), *uses[position + 1 :])

    def _used(self, use: _Use, move: _Move) -> _Use:
        """The use of an instance after a move to it."""
        number, position, bank = move
        if bank == WHOLE:
            used = tuple(len(slots.slots) for slots in self.instances[position].banks)
        else:
            used = (*use.used[:bank], use.used[bank] + 1, *use.used[bank + 1 :])
        return _Use(used, self.groups[number].agree)

    def _key(self, state: _State) -> Hashable:
        """The state without the names of instances, to recognize equal states."""
        remaining, uses = state
        used = sorted((i.profile, use.used, use.agree) for i, use in zip(self.instances, uses))
        return remaining, tuple(used)

    def _hopeful(self, state: _State) -> bool:
        """False if the remaining demands certainly do not fit."""
        return self._enough_instances(state) and self._enough_places(state)

    def _enough_instances(self, state: _State) -> bool:
        """True if there are enough unused instances, by their number only.

        Demands that agree on a value fill up the instances that have this value.  The rest of them needs unused
        instances, and so does each demand for a whole instance.
        """
        remaining, uses = state
        empty = sum(use.agree < 0 for use in uses)
        needed = 0
        slots_needed: dict[int, int] = {}
        for group, count in zip(self.groups, remaining):
            if group.whole:
                needed += count
            elif count:
                slots_needed[group.agree] = slots_needed.get(group.agree, 0) + count
        for agree, count in slots_needed.items():
            for instance, use in zip(self.instances, uses):
                if use.agree == agree:
                    count -= sum(len(bank.slots) for bank in instance.banks) - sum(use.used)
            needed += -(-max(0, count) // self.slots) if self.slots else 0
        return needed <= empty

    def _enough_places(self, state: _State) -> bool:
        """True if a maximum flow from groups to free places serves all remaining demands.

        For unused instances, the agreement of users is ignored.  Thus True does not mean that there is a solution.
        """
        remaining, uses = state
        capacity: dict[tuple[int, int], int] = {}
        reach: list[list[tuple[int, int]]] = [[] for _ in self.groups]
        for position, (instance, use) in enumerate(zip(self.instances, uses)):
            for bank, (slots, used) in enumerate(zip(instance.banks, use.used)):
                if used < len(slots.slots):
                    capacity[position, bank] = len(slots.slots) - used
                    for number in slots.groups:
                        if remaining[number] and use.agree in (-1, self.groups[number].agree):
                            reach[number].append((position, bank))
            if use.agree < 0 and instance.whole:
                capacity[position, WHOLE] = 1
                for number in instance.whole:
                    if remaining[number]:
                        reach[number].append((position, WHOLE))
        taken: dict[tuple[int, int], dict[int, int]] = {place: {} for place in capacity}
        return all(
            _route(number, reach, capacity, taken) for number, count in enumerate(remaining) for _ in range(count)
        )


def _route(
    group: int,
    reach: Sequence[Sequence[tuple[int, int]]],
    capacity: dict[tuple[int, int], int],
    taken: dict[tuple[int, int], dict[int, int]],
) -> bool:
    """Finds a place for one more demand of ``group``, and moves others if necessary.

    This is an augmenting path, found breadth first (Edmonds-Karp).  False if there is none.
    """
    came_from: dict[tuple[int, int], int] = {}
    place_of: dict[int, tuple[int, int]] = {}
    queue = [group]
    for current in queue:
        for place in reach[current]:
            if place in came_from:
                continue
            came_from[place] = current
            if sum(taken[place].values()) < capacity[place]:
                while True:
                    taker = came_from[place]
                    taken[place][taker] = taken[place].get(taker, 0) + 1
                    if taker == group:
                        return True
                    place = place_of[taker]
                    taken[place][taker] -= 1
            for other, count in taken[place].items():
                if count and other not in place_of and other != group:
                    place_of[other] = place
                    queue.append(other)
    return False


def _groups(demands: Sequence[Demand]) -> tuple[_Group, ...]:
    members: dict[Demand, list[int]] = {}
    for index, demand in enumerate(demands):
        members.setdefault(demand, []).append(index)
    agreements: dict[Hashable, int] = {}
    for demand in members:
        agreements.setdefault(demand.agree, len(agreements))
    return tuple(
        _Group(
            agree=agreements[demand.agree],
            members=tuple(indices),
            whole=bool(demand.places) and all(slot == WHOLE for _, slot in demand.places),
        )
        for demand, indices in members.items()
    )


def _instances(demands: Sequence[Demand], groups: Sequence[_Group], costs: Sequence[int]) -> tuple[_Instance, ...]:
    """The instances that at least one group can use, the cheapest first."""
    seen: dict[int, dict[int, set[int]]] = {}  # instance -> slot -> groups
    for number, group in enumerate(groups):
        for index, slot in demands[group.members[0]].places:
            seen.setdefault(index, {}).setdefault(slot, set()).add(number)
    profiles: dict[Hashable, int] = {}
    result: list[_Instance] = []
    for index in sorted(seen):
        by_groups: dict[frozenset[int], list[int]] = {}
        for slot in sorted(slot for slot in seen[index] if slot != WHOLE):
            by_groups.setdefault(frozenset(seen[index][slot]), []).append(slot)
        ordered = sorted(by_groups.items(), key=lambda item: sorted(item[0]))
        banks = tuple(_Bank(numbers, tuple(slots)) for numbers, slots in ordered)
        whole = frozenset(seen[index].get(WHOLE, ()))
        alike = (tuple((bank.groups, len(bank.slots)) for bank in banks), whole)
        users = frozenset(number for numbers in seen[index].values() for number in numbers)
        pressure = sum(len(groups[number].members) for number in users)
        cost = costs[index] if index < len(costs) else 0
        profile = profiles.setdefault(alike, len(profiles))
        result.append(_Instance(index, profile, banks, whole, users, pressure, cost))
    return tuple(sorted(result, key=lambda instance: (instance.cost, instance.index)))
