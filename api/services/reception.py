"""What became of the data of a device: the receipts of its chunks, summed up."""

from datetime import datetime, timedelta

from api import schemas
from storage.database import ReadSession


def read(tx: ReadSession, device_pk: int, until: datetime, period: timedelta) -> schemas.Reception:
    """Sum up what came in within a period that ends at `until`."""
    del tx, device_pk
    return schemas.Reception(
        since=until - period,
        until=until,
        chunks=0,
        samples=0,
        fixes=0,
        rejected={},
        waiting=0,
        lost=[],
        sessions=[],
        rates=schemas.ReceptionRates(time=[], sample_rate_hz=[], fix_rate_hz=[], rejected=[]),
    )
