"""Decks as Python values: reads the effective decks that Amontons writes, and writes decks of dicts.

A deck is a list of pairs, the name of a group and its keys and values, in the order of the file.
"""
from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

from amontons.arguments import InputRefused

_GROUP = re.compile(r"""&(\w+)((?:[^'"/!]|!.*|'(?:[^'\n]|'')*'|"(?:[^"\n]|"")*")*)/|!.*|\S""")
_PIECE = re.compile(r"""!.*|(\w+)\s*=|('(?:[^'\n]|'')*'|"(?:[^"\n]|"")*")|([^\s,'"=!]+)""")
_LOGICAL = {True: ".true.", False: ".false."}


def read_deck(text: str) -> list[tuple[str, dict[str, Any]]]:
    """The groups of an effective deck, NAME.deck.nml: a value alone as itself, several as a list."""
    groups: list[tuple[str, dict[str, Any]]] = []
    for match in _GROUP.finditer(text):
        if match[1]:
            keys: dict[str, list[Any]] = {}
            values: list[Any] = []
            for key, quoted, word in _PIECE.findall(match[2]):
                if key:
                    values = keys.setdefault(key.lower(), [])
                elif quoted or word:
                    values.append(quoted[1:-1].replace(2 * quoted[0], quoted[0]) if quoted else _number(word))
            groups.append((match[1].lower(), {key: values[0] if len(values) == 1 else values
                                              for key, values in keys.items()}))
    return groups


def _number(word: str) -> Union[int, float, str]:
    """The number that a word is, or the word."""
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            pass
    return word


def deck_text(groups: Mapping[str, Union[Mapping[str, Any], Sequence[Mapping[str, Any]]]]) -> str:
    """The text of a deck: a dict of groups, each a dict of keys, or a list of such dicts for a group that is repeated.
    A key whose value is None is left out.

        deck_text({"mesh": {"size": (40, 40), "cells": (32, 10)}, "support": [{"set": "left", "ux": 0.0}]})
    """
    lines = []
    for name, entries in groups.items():
        listed = [entries] if isinstance(entries, Mapping) else entries
        if not (isinstance(listed, (list, tuple)) and all(isinstance(entry, Mapping) for entry in listed)):
            raise InputRefused(f"deck: &{name}: expected a dict of keys or a list of them, found {entries!r}")
        for entry in listed:
            lines.append(f"&{name} " + "  ".join(f"{key} = {value_text(value)}" for key, value in entry.items()
                                              if value is not None) + " /")
    return "\n".join(lines) + "\n"


def value_text(value: Any) -> str:
    """A value as a deck has it: text in quotes, several numbers separated by commas."""
    if isinstance(value, (str, Path)):
        return "'" + str(value).replace("'", "''") + "'"
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, (list, tuple, range)):
        return ", ".join(map(value_text, value))
    return _LOGICAL[value] if isinstance(value, bool) else repr(value)
