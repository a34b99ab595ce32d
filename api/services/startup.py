"""What happens before the first request: migrations, secrets, the first admin key, the compiled estimator."""

import numpy as np

import core
from api.formats import parse
from api.services import detecting, keyring
from api.services.context import Context
from core.motion import VEHICLES, reconstruct
from storage import events, meta, migrate

LEVEL = np.array([1.0, 0.0, 0.0, 0.0])


def prepare(context: Context) -> str | None:
    """Bring the database up to date; give the first admin key if this call made it, for the caller to show once.

    Several processes may call this at once: one does the work, the others wait for it.
    """
    migrate.upgrade(context.database)
    with context.database.write() as tx:
        migrate.lock(tx)
        if meta.get(tx, events.PRUNED) is None:
            meta.put(tx, events.PRUNED, "0.0")
        return keyring.first_admin_key(tx, context)


def warm_up(params: core.Parameters) -> None:
    """Compile what reads CSV, estimates, detects events and reconstructs, on two seconds of a parked vehicle."""
    parse(b"t,ax,ay,az,fix,speed,course\n0,0,0,9.81,1,0,0\n", "text/csv", None)
    t = np.arange(0.0, 2.0, 0.01)
    f_s = np.tile([0.0, 0.0, 9.81], (t.size, 1))
    rows = np.arange(0, t.size, 25)
    fix = np.full((rows.size, len(core.FIX_COLUMNS)), np.nan)
    fix[:, [core.FIX_COLUMNS.index(name) for name in ("speed", "course")]] = 0.0
    for w_s in (None, np.zeros_like(f_s)):
        samples = core.Samples.make(t, f_s, w_s, rows, np.ones(rows.size, np.bool_), fix)
        state = core.begin_session(params, core.initial_state(params))
        state, _ = core.advance(params, state, samples)
        core.decode(core.encode(state))
        detecting.detect(None, LEVEL, (), samples)
        reconstruct(VEHICLES["sedan"], LEVEL, samples)
