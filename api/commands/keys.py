"""`livella keys`: administer the keys in the database itself, the way back in when every admin key is lost."""

from datetime import datetime, timedelta
from typing import Any

import typer

from api.commands import output
from api.commands.surroundings import configure, opened
from api.services import access, auditing, keyring
from api.services.errors import NotFoundError
from storage import keys, migrate

LONGEST_NAME = 128
HEADS = ("number", "prefix", "role", "name", "device", "made", "last used", "expires")


def show(flags: dict[str, Any]) -> None:
    """Print a table of the keys."""
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        with context.database.read() as tx:
            known = keys.every(tx)
    output.print_table(HEADS, map(_row, known), folded=("name",))


def _row(key: keys.Entry) -> list[str]:
    what = [str(key.pk), key.prefix or "", key.role, key.name, key.device_id or ""]
    return [*what, *map(_moment, (key.created_at, key.last_used_at, key.expires_at))]


def _moment(moment: datetime | None) -> str:
    return "" if moment is None else f"{moment:%Y-%m-%d %H:%MZ}"


def create(flags: dict[str, Any], role: str, name: str, device_id: str | None, expires_days: float | None) -> None:
    """Make a key and print it; with the role device it is for one device, which has to be registered."""
    if (role == access.Role.DEVICE.word) != (device_id is not None):
        raise typer.BadParameter("--device goes with --role device, and with no other role", param_hint="--device")
    name = (name or device_id or "").strip()
    if not 0 < len(name) <= LONGEST_NAME:
        raise typer.BadParameter(f"expected 1 to {LONGEST_NAME} characters", param_hint="--name")
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        until = None if expires_days is None else context.clock() + timedelta(days=expires_days)
        wanted = keyring.Wanted(role, name, device_id, until)
        try:
            made = keyring.create(context, auditing.COMMAND_LINE, wanted)
        except NotFoundError:
            output.fail(f"There is no device {device_id}.", output.UNREADABLE)
    typer.echo(made.key)


def revoke(flags: dict[str, Any], number: int) -> None:
    """Revoke a key; here also the last admin's, because here another one can be made."""
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        try:
            keyring.revoke(context, auditing.COMMAND_LINE, number, last_admin_too=True)
        except NotFoundError:
            output.fail(f"There is no key number {number}.", output.UNREADABLE)
    typer.echo(f"Key number {number} is revoked.")
