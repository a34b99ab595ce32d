"""Keys: made, listed, revoked, and the one a service starts with."""

from datetime import datetime
from typing import NamedTuple, NoReturn

from api import schemas
from api.services import access, auditing
from api.services.access import Principal, Role
from api.services.context import Context
from api.services.errors import UNKNOWN_DEVICE, ExpiryError, LastAdminError, NotFoundError
from storage import devices, keys
from storage.database import ReadSession, WriteSession


class Wanted(NamedTuple):
    """A key to be made."""

    role: str
    name: str
    device_id: str | None = None
    expires_at: datetime | None = None


def create(context: Context, principal: Principal, wanted: Wanted) -> schemas.CreatedKey:
    """Make a key, which is shown only now."""
    now = context.clock()
    if wanted.expires_at is not None and wanted.expires_at <= now:
        raise ExpiryError("`expires_at` has to lie in the future.")
    with context.database.write() as tx:
        device_pk = None if wanted.device_id is None else _device(tx, wanted.device_id)
        pk, key = make(tx, principal, wanted, now, device_pk)
        told = {"role": wanted.role, "name": wanted.name, "device_id": wanted.device_id}
        auditing.record(tx, principal, "key.create", f"keys/{pk}", told, now)
        return schemas.CreatedKey(**present(_found(tx, pk)).model_dump(), key=key)


def make(
    tx: WriteSession, principal: Principal, wanted: Wanted, now: datetime, device_pk: int | None = None
) -> tuple[int, str]:
    """Make a key in a transaction that tells about it; give its number and the key."""
    key = access.new_key()
    pk = keys.add(
        tx,
        access.digest(key),
        wanted.role,
        wanted.name,
        now,
        device_pk,
        prefix=key[: access.SHOWN],
        expires_at=wanted.expires_at,
        created_by=principal.name,
    )
    return pk, key


def replace_of_device(tx: WriteSession, principal: Principal, device_pk: int, device_id: str, now: datetime) -> str:
    """Make a new key for a device and revoke what it had; give the key."""
    keys.remove_of_device(tx, device_pk)
    return make(tx, principal, Wanted(Role.DEVICE.word, device_id), now, device_pk)[1]


def revoke(context: Context, principal: Principal, pk: int, last_admin_too: bool = False) -> None:
    """Revoke a key; not the last one that may administer, for then nobody could make another."""
    now = context.clock()
    with context.database.write() as tx:
        entry = _found(tx, pk)
        if entry.role == Role.ADMIN.word and not last_admin_too:
            _keep_one(keys.lock_valid_of_role(tx, Role.ADMIN.word, now), pk)
        if not keys.remove(tx, pk):
            _unknown()
        told = {"role": entry.role, "name": entry.name, "device_id": entry.device_id}
        auditing.record(tx, principal, "key.revoke", f"keys/{pk}", told, now)


def _keep_one(valid: list[int], pk: int) -> None:
    if valid == [pk]:
        raise LastAdminError("Make another admin key first: with this one the last way to administer would be gone.")


def present(entry: keys.Entry) -> schemas.Key:
    """Give a key as a document, without its secret, which nobody has."""
    shown = entry._asdict()
    return schemas.Key(id=shown.pop("pk"), **shown)


def first_admin_key(tx: WriteSession, context: Context) -> str | None:
    """Make sure there is an admin key; give the key when one was made, so that it can be shown once."""
    chosen, now = context.settings.admin_key, context.clock()
    if chosen is not None:
        _use_chosen_key(tx, chosen.get_secret_value(), now)
        return None
    if keys.valid_of_role(tx, Role.ADMIN.word, now):
        return None
    pk, key = make(tx, auditing.SERVICE, Wanted(Role.ADMIN.word, "first admin"), now)
    auditing.record(tx, auditing.SERVICE, "key.create", f"keys/{pk}", {"role": Role.ADMIN.word}, now)
    return key


def _use_chosen_key(tx: WriteSession, key: str, now: datetime) -> None:
    """Make the key from the environment the only one of that origin; nothing of a chosen key is shown."""
    if keys.by_digest(tx, access.digest(key)) is not None:
        return
    keys.remove_source(tx, keys.ENVIRONMENT)
    by = auditing.SERVICE
    pk = keys.add(tx, access.digest(key), Role.ADMIN.word, "admin", now, source=keys.ENVIRONMENT, created_by=by.name)
    auditing.record(tx, by, "key.create", f"keys/{pk}", {"role": Role.ADMIN.word}, now)


def _device(tx: ReadSession, device_id: str) -> int:
    pk = devices.exists(tx, device_id)
    if pk is None:
        raise NotFoundError(UNKNOWN_DEVICE)
    return pk


def _found(tx: ReadSession, pk: int) -> keys.Entry:
    entry = keys.find(tx, pk)
    if entry is None:
        _unknown()
    return entry


def _unknown() -> NoReturn:
    raise NotFoundError("There is no such key.")
