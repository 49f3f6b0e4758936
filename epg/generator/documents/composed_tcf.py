# SPDX-License-Identifier: Apache-2.0
"""Target configurations that are composed of a target, a robot and the robot's wiring, without a file for each of them.

``<target>_<robot>.tcf`` names the target, and extends the first of these files in the folders of the robot:

1. ``<board>_<platform>_<robot>.tcf``, then ``<board>_<robot>.tcf``: the wiring.  First those of the target's board,
   then those of each board that this board extends.
2. ``<robot>.tcf``: the robot.  A board without a wiring gets its pins in the file of the user.

A file with the name of a composed configuration is read instead of it.

>>> # composed_tcf("rpi_pico2_w_zephyr_jiwy.tcf", roots).text
'version: 1\\nextends: rpi_pico_jiwy.tcf\\ntarget: rpi_pico2_w_zephyr\\n'
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

from epg.generator.dataclass import dataclass
from epg.generator.diagnostics import Diagnostics
from epg.generator.documents.text_file import is_file
from epg.generator.documents.yaml_file import load_yaml


@dataclass(frozen=True)
class FoundTcf:
    """The file of a configuration; or its ``text`` if it is composed, and the ``path`` at which its file would be.

    A file at one of ``absent`` would change a composed one.  None of them exists; ``path`` is one of them.
    """

    path: Path
    text: str | None = None
    absent: tuple[Path, ...] = ()


def composed_tcf(name: str, roots: Sequence[Path]) -> FoundTcf | None:
    """The configuration ``name``, with or without ``.tcf``; None if it names no board, platform and robot."""
    stem = name.removesuffix(".tcf")
    robots = _robot_files(roots)
    for robot in robots:
        target = stem.removesuffix(f"_{robot}")
        named = target != stem and _has_no_target(robot, robots)
        if named and (split := next(_splits(target, roots), None)):
            return _composed(stem, target, robot, list(_extended(*split, robot, roots)), roots)
    return None


def _composed(stem: str, target: str, robot: str, files: Sequence[str], roots: Sequence[Path]) -> FoundTcf:
    """The configuration that extends the first of ``files``; the last of them, that of the robot, exists."""
    folders = [root / "robots" / robot for root in roots]
    places = [folder / file for file in files for folder in folders]
    first = next(number for number, place in enumerate(places) if is_file(place))
    absent = (*(folder / f"{stem}.tcf" for folder in folders), *places[:first])
    text = f"version: 1\nextends: {places[first].name}\ntarget: {target}\n"
    return FoundTcf(places[first].parent / f"{stem}.tcf", text, absent)


def _robot_files(roots: Sequence[Path]) -> dict[str, Path]:
    """The file ``<robot>.tcf`` in the folder of each robot."""
    files: dict[str, Path] = {}
    for root in roots:
        for folder in (root / "robots").glob("*/"):
            if is_file(file := folder / f"{folder.name}.tcf"):
                files.setdefault(folder.name, file)
    return dict(sorted(files.items()))


def _has_no_target(name: str, files: Mapping[str, Path]) -> bool:
    """True if neither the file of the robot states a target, nor those of the robots that it extends."""
    read: set[str] = set()
    while name in files and name not in read:
        read.add(name)
        node = load_yaml(files[name], Diagnostics())
        if node is None or not node.is_mapping or "target" in node:
            return False
        if "extends" not in node:
            return True
        name = str(node["extends"].value).removesuffix(".tcf")
    return False


def composed_names(targets: Iterable[str], roots: Sequence[Path]) -> set[str]:
    """The names of the composed configurations of ``targets``."""
    files = _robot_files(roots)
    robots = [name for name in files if _has_no_target(name, files)]
    return {f"{target}_{robot}.tcf" for target in targets for robot in robots}


def possible_targets(roots: Sequence[Path]) -> list[str]:
    """Each platform with each board, also if it does not support the board's chip: to find a mistyped name."""
    boards, platforms = (set(_names(each, f"{each}s", roots)) for each in ("board", "platform"))
    alone = boards & platforms  # a platform with one board has the name of its board
    return [*alone, *(f"{board}_{platform}" for board in boards - alone for platform in platforms - alone)]


def _splits(target: str, roots: Sequence[Path]) -> Iterator[tuple[str, str]]:
    """The pairs of board and platform whose names together are ``target``; the board of a platform alone is empty."""
    for platform in _names("platform", "platforms", roots):
        board = target.removesuffix(platform).removesuffix("_")
        if target == platform or (target == f"{board}_{platform}" and _board_file(board, roots)):
            yield board, platform


def _extended(board: str, platform: str, robot: str, roots: Sequence[Path]) -> Iterator[str]:
    """The names of the files that a composed configuration can extend, the best one first."""
    read: set[str] = set()
    own = f"{board}_{platform}_{robot}.tcf"
    while board and board not in read:
        read.add(board)
        yield from (file for file in (f"{board}_{platform}_{robot}.tcf", f"{board}_{robot}.tcf") if file != own)
        path = _board_file(board, roots)
        node = load_yaml(path, Diagnostics()) if path is not None else None
        extends = node.get("extends") if node is not None else None
        board = str(extends.value) if extends is not None else ""
    yield f"{robot}.tcf"


def _board_file(board: str, roots: Iterable[Path]) -> Path | None:
    return next((path for root in roots if is_file(path := root / "boards" / board / "board.yaml")), None)


def _names(category: str, folder: str, roots: Iterable[Path]) -> list[str]:
    return sorted({path.parent.name for root in roots for path in (root / folder).glob(f"*/{category}.yaml")})
