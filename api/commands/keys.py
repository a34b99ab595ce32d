"""`livella keys`: administer the keys in the database itself, the way back in when every admin key is lost."""

from typing import Any

import typer

from api.commands import output
from api.commands.surroundings import configure, opened
from api.services import access
from storage import devices, keys, migrate
from storage.database import WriteSession

LONGEST_NAME = 128


def show(flags: dict[str, Any]) -> None:
    """Print a table of the keys."""
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        with context.database.read() as tx:
            known = keys.every(tx)
    rows = ([str(key.pk), key.role, key.name, key.device_id or ""] for key in known)
    output.print_table(("number", "role", "name", "device"), rows)


def create(flags: dict[str, Any], role: str, name: str, device_id: str | None) -> None:
    """Make a key and print it; with the role device it is for one device, which has to be registered."""
    if (role == access.Role.DEVICE.word) != (device_id is not None):
        raise typer.BadParameter("--device goes with --role device, and with no other role", param_hint="--device")
    name = (name or device_id or "").strip()
    if not 0 < len(name) <= LONGEST_NAME:
        raise typer.BadParameter(f"expected 1 to {LONGEST_NAME} characters", param_hint="--name")
    key = access.new_key()
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        with context.database.write() as tx:
            number = None if device_id is None else _device(tx, device_id)
            keys.add(tx, access.digest(key), role, name, context.clock(), number)
    typer.echo(key)


def revoke(flags: dict[str, Any], number: int) -> None:
    """Revoke a key."""
    with opened(configure(flags)) as context:
        migrate.upgrade(context.database)
        with context.database.write() as tx:
            if not keys.remove(tx, number):
                output.fail(f"There is no key number {number}.", output.UNREADABLE)
    typer.echo(f"Key number {number} is revoked.")


def _device(tx: WriteSession, device_id: str) -> int:
    number = devices.exists(tx, device_id)
    if number is None:
        output.fail(f"There is no device {device_id}.", output.UNREADABLE)
    return number
