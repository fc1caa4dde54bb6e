"""Numbers in texts, in the form that the program has in its listings."""
from __future__ import annotations


def scientific(value: float, digits: int = 3) -> str:
    """A number rounded to a few digits: 0.704, 1730.0, 1.0e-8. An exponent has no zero before it."""
    mantissa, letter, exponent = repr(float(f"{value:.{digits - 1}e}")).partition("e")
    if not letter:
        return mantissa
    return f"{mantissa if '.' in mantissa else mantissa + '.0'}e{int(exponent)}"
