"""What arguments of the package may be: arrays of real numbers, numbers, whole numbers. All else is refused with a
sentence; nothing is cut or made of a text."""
from __future__ import annotations

import operator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from amontons.grid import Array


class AmontonsError(Exception):
    """What Amontons cannot do; its text is the program's sentence."""


class InputRefused(AmontonsError, ValueError):
    """A deck, an array or an argument is at fault."""


def real_numbers(value: ArrayLike, name: str) -> Array:
    """An array of real numbers, as numbers of double precision."""
    array = _array(value, name, "real numbers")
    if array.dtype == object:  # of numbers that NumPy has no type for
        try:
            array = np.array([float(number) for number in array.flat]).reshape(array.shape)
        except (TypeError, ValueError, OverflowError):
            pass
    if array.dtype.kind not in "biuf":
        raise InputRefused(f"{name}: expected real numbers, found {_kind_of(value, array)}")
    return np.asarray(array, dtype=np.float64)


def real_number(value: Any, name: str) -> float:
    """One real number."""
    number = real_numbers(value, name)
    if number.ndim:
        raise InputRefused(f"{name}: expected one number, found an array of shape {number.shape}")
    return float(number)


def whole_numbers(value: ArrayLike, name: str) -> Array:
    """An array of whole numbers."""
    array = _array(value, f"'{name}'", "whole numbers")
    if array.dtype.kind not in "iu":
        raise InputRefused(f"'{name}': expected whole numbers, found {_kind_of(value, array)}")
    return array


def whole_number(value: Any, name: str) -> int:
    """One whole number, as the library can hold it."""
    try:
        number = operator.index(value)
    except TypeError:
        raise InputRefused(f"{name}: expected a whole number, found {type(value).__name__}") from None
    if abs(number) >= 2**31:
        raise InputRefused(f"{name}: expected a whole number of at most {2**31 - 1}, found {number}")
    return number


def _array(value: ArrayLike, name: str, kind: str) -> Array:
    """An array of whatever the value has."""
    try:
        return np.asarray(value)
    except (TypeError, ValueError):
        raise InputRefused(f"{name}: expected {kind} in rows of one length, found {type(value).__name__}") from None


def _kind_of(value: ArrayLike, array: Array) -> str:
    """What a value is that is not taken: the kind of its numbers, or its type."""
    return str(array.dtype) if array.dtype.kind in "biufc" else type(value).__name__
