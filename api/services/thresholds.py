"""What the service decides by, each with its unit and its meaning, for people."""

from collections.abc import Iterator

from api import schemas
from api.services.context import Context


def listed(context: Context) -> schemas.Thresholds:
    """Give them all."""
    return schemas.Thresholds(items=list(_rows(context)))


def _rows(context: Context) -> Iterator[schemas.Threshold]:
    yield from ()
