"""What reading a log gives, the same for every format."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from api.formats.fingerprint import Fingerprint
from core import Samples

Context = dict[str, Any]
"""What must be remembered from one chunk of a session to the next; JSON values only. Empty at the start."""


class Reading(NamedTuple):
    """One chunk as samples."""

    samples: Samples
    rejected: dict[str, int]
    """GPS reports left out, counted by reason"""
    context: Context
    """to be given with the next chunk"""


@dataclass(frozen=True)
class ParsedLog:
    """A log that has been read and found sound; nothing of it can be refused any more."""

    media_type: str
    fingerprint: Fingerprint
    notices: tuple[str, ...]
    """what the sender should know, such as columns that were ignored"""
    rows: int
    read: Callable[[Context], Reading]

    def samples(self, context: Context | None = None) -> Reading:
        """Give the samples, SI units and radians, in the light of the chunks before."""
        return self.read(dict(context or {}))
