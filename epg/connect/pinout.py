# SPDX-License-Identifier: Apache-2.0
"""The pins of a target: the board's drawing, the pins that a signal can have, and changes of pins.

The drawing, the list of pins and the answer to a change are made of the same options
(:func:`epg.generator.resolve.pin_options.pin_options`), so they cannot disagree.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

from epg.connect.body import Refused
from epg.connect.draft import SetValue
from epg.connect.json_data import Data
from epg.connect.loaded import Loaded
from epg.generator.catalog.board_layout import Contact
from epg.generator.check.configuration import Configuration
from epg.generator.documents.items import pin_list
from epg.generator.resolve.first_fit import ClaimSignal, first_fit, signals_of, usable_pin
from epg.generator.resolve.pin_options import PinOption
from epg.graph.terminals import printed_names
from epg.graph.wiring import PinChoice, draw_wiring


def signals_view(loaded: Loaded) -> list[Data]:
    """All signals of the target that need a pin, in the order of the ``.tcf``, with their present pins.

    ``pin`` is empty if there is none, or if the board does not have it.
    """
    configuration = loaded.wired
    if configuration is None:
        return []
    return [
        {"component": component, "signal": signal, "pin": _title(configuration, pin)}
        for (component, signal), pin in signals_of(configuration).items()
    ]


def problems_view(loaded: Loaded) -> list[Data]:
    """The errors of pins and peripherals, each with a signal whose pin can be changed."""
    return [
        {"component": component, "signal": signal, "message": message}
        for (component, signal), message in loaded.pin_problems
    ]


def options_view(loaded: Loaded, signal: ClaimSignal) -> list[Data]:
    """The pins of the board for ``signal``.  Raises Refused if there is no such signal."""
    configuration, options = _asked(loaded, signal)
    contacts = _contacts(configuration)
    return [
        {
            "pin": configuration.target.board.pin_title(option.pin),
            "printed": printed_names(configuration.target, option.pin),
            "contact": contacts[option.pin].title if option.pin in contacts else "",
            "state": option.state,
            "reason": option.reason,
            "changes": [
                {"component": component, "signal": name, "pin": pin}
                for (component, name), pin in option.changes.items()
            ],
        }
        for option in options
    ]


def draw_pinout(loaded: Loaded, title: str, signal: ClaimSignal | None = None, *, for_page: bool = False) -> str | None:
    """The board with its wires, as the files state them, also with conflicts; None if the target has no pins.

    With ``signal``, the contacts show if they can have it.
    """
    configuration = loaded.wired
    if configuration is None or configuration.target.board.layout is None:
        return None
    wrong = [signal for signal, _ in loaded.pin_problems]
    choice = PinChoice(signal, _asked(loaded, signal)[1]) if signal is not None else None
    return draw_wiring(
        configuration.target, configuration.components, loaded.wiring, title, choice, wrong, for_page=for_page
    )


def chosen_pin(loaded: Loaded, signal: ClaimSignal, pin: str) -> tuple[SetValue, ...]:
    """The changes that give ``pin`` to ``signal``.  Raises Refused with the pins that fit, if it cannot have it."""
    configuration, options = _asked(loaded, signal)
    board = configuration.target.board
    name = board.pin_name(pin)
    option = next((each for each in options if each.pin == name), None)
    if option is not None and option.state == "current":
        return ()
    if option is not None and option.changes:
        return _set(option.changes)
    reason = option.reason if option is not None else f"{board.name} has no such pin"
    fitting = [board.pin_title(each.pin) for each in options if each.state == "fits"]
    hint = f"pins that fit: {pin_list(fitting)}" if fitting else "no other pin fits: move another signal first"
    raise Refused(f"{pin} cannot be {' '.join(signal)}: {reason}", hint, 409)


def first_pins(loaded: Loaded, wanted: Collection[ClaimSignal] | None) -> tuple[SetValue, ...]:
    """The changes that give the first pins that fit to the signals in ``wanted``, or to all that lack one.

    Raises Refused if there are no such pins.
    """
    configuration = loaded.wired
    if configuration is None:
        raise Refused("pins cannot be proposed yet", "correct the other errors first", 409)
    written = signals_of(configuration)
    for signal in wanted or ():
        if signal not in written:
            raise Refused(f"there is no signal '{' '.join(signal)}'", status=404)
    asked = lacking_pins(configuration) if wanted is None else wanted
    pins = first_fit(configuration, loaded.period, asked)
    if pins is None:
        names = ", ".join(" ".join(signal) for signal in asked)
        raise Refused(f"no free pins fit {names}", "move or remove another component first", 409)
    return _set({signal: pin for signal, pin in pins.items() if _title(configuration, written[signal]) != pin})


def lacking_pins(configuration: Configuration) -> list[ClaimSignal]:
    """The signals without a pin, and those whose pin the board does not have or cannot use."""
    written = signals_of(configuration)
    return [signal for signal, pin in written.items() if not pin or not usable_pin(configuration.target, pin)]


def _set(pins: Mapping[ClaimSignal, str]) -> tuple[SetValue, ...]:
    return tuple(SetValue(("components", component, "pins", name), pin) for (component, name), pin in pins.items())


def _asked(loaded: Loaded, signal: ClaimSignal) -> tuple[Configuration, Sequence[PinOption]]:
    configuration = loaded.wired
    options = loaded.pin_options(signal)
    if configuration is None or not options:
        raise Refused(f"there is no signal '{' '.join(signal)}' that needs a pin", status=404)
    return configuration, options


def _title(configuration: Configuration, written: str) -> str:
    """The title of a pin that the board has; empty for others."""
    board = configuration.target.board
    return board.pin_title(board.pin_name(written)) if written and usable_pin(configuration.target, written) else ""


def _contacts(configuration: Configuration) -> dict[str, Contact]:
    layout = configuration.target.board.layout
    rows = layout.rows if layout is not None else ()
    return {contact.pin: contact for row in rows for contact in row.contacts if contact.pin}
