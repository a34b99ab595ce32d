"""The fleet in the baseline's database, before and after."""

import secrets
from collections.abc import Sequence

from sqlalchemy import create_engine, func, select
from sqlalchemy.orm import Session

from benchmarks import naive
from benchmarks.load_study.client import Body, Device

SESSION = "drive"


def settle(url: str, bodies: Sequence[Sequence[Body]], n: int) -> list[Device]:
    """Make the tables with `n` devices in them, and give those as they will send."""
    made = [
        Device(f"box-{i:06}", secrets.token_urlsafe(32), SESSION, bodies[i % len(bodies)], first_seq=0)
        for i in range(n)
    ]
    engine = create_engine(url)
    naive.Base.metadata.create_all(engine)
    with Session(engine) as session:
        session.add_all(naive.Device(id=box.name, key_hash=naive.key_hash(box.key)) for box in made)
        session.commit()
    engine.dispose()
    return made


def count_wrong(url: str, devices: Sequence[Device]) -> int:
    """Count the devices whose stored chunks are not as many as were acknowledged."""
    engine = create_engine(url)
    counted = select(naive.Chunk.device_id, func.count()).group_by(naive.Chunk.device_id)
    with Session(engine) as session:
        found = {row[0]: row[1] for row in session.execute(counted)}
    engine.dispose()
    return sum(not box.stored_as_told(found.get(box.name, 0)) for box in devices)
