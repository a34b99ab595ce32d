"""Integers that stand for numbers with a fraction, as sensors count them: half as many bytes as 32-bit floats.

The field of an Arrow schema says so in its metadata, by the names of the climate and forecast (CF) conventions,
section 8.1 "Packed Data": value = stored * scale_factor + add_offset.
"""

import re
from typing import Any, Final, NamedTuple, Self

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from api.formats.delimited import Floats
from api.formats.errors import FormatError, Problem, printable

FACTOR: Final = b"scale_factor"
OFFSET: Final = b"add_offset"
LARGEST: Final = 1e30
"""of a factor or an offset; with it no integer becomes infinite"""
_NUMBER: Final = re.compile(rb"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?")
_LONGEST: Final = 40
"""characters of a number"""


class Scale(NamedTuple):
    """What a stored integer stands for."""

    factor: float
    offset: float

    @classmethod
    def of(cls, field: pa.Field) -> Self | None:
        """Give what the metadata of a field say, None where they say nothing.

        Raises
        ------
        FormatError
            422: the column has no integers, or what is said is no number.
        """
        metadata = field.metadata
        if not metadata or not (FACTOR in metadata or OFFSET in metadata):
            return None
        if field.name == "fix" or not pa.types.is_integer(field.type):
            what = "fix without a scale" if field.name == "fix" else "integers where there is a scale_factor"
            raise _refused(field.name, what, f"expected {what}, found {field.type} with one")
        factor, offset = _number(field, FACTOR, b"1"), _number(field, OFFSET, b"0")
        if factor == 0.0:
            raise _refused(field.name, "a scale_factor other than 0", "expected a scale_factor other than 0")
        return cls(factor, offset)

    def values(self, stored: NDArray[Any], out: Floats | None = None) -> Floats:
        """Give what integers stand for, in 64 bits; into `out` if that is given."""
        values: Floats = np.multiply(stored, np.float64(self.factor), out=out)
        if self.offset:
            values += self.offset
        return values


Scales = dict[str, Scale]
"""by the names of the columns that have one"""


def _number(field: pa.Field, key: bytes, default: bytes) -> float:
    text = field.metadata.get(key, default)
    is_number = len(text) <= _LONGEST and _NUMBER.fullmatch(text) is not None
    if not is_number or not abs(number := float(text)) <= LARGEST:
        expected = f"{key.decode()} as the text of a number, of {LARGEST:.0e} at most"
        found = printable(text[:_LONGEST].decode(errors="replace"))
        raise _refused(field.name, expected, f"expected {expected}, found '{found}'")
    return number


def _refused(name: str, expected: str, message: str) -> FormatError:
    return FormatError.unreadable(Problem(None, printable(name), expected, message))
