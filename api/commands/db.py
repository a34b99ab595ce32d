"""`livella db`: bring the database up to date, back it up, restore it, check it."""

import os
import shutil
import sqlite3
import subprocess
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import sqlalchemy as sa
import typer

from api.commands import output
from api.commands.surroundings import configure, opened
from storage import migrate as migrations
from storage.database import Database

VERSION_TABLE = "alembic_version"
"""there in every database of ours, and in no empty one"""
ONLY_OWNER = 0o600
"""a backup holds what the database holds: hashes of keys, the secret of the sign-ins"""


def migrate(flags: dict[str, Any]) -> None:
    """Apply the migrations that are missing."""
    with opened(configure(flags)) as context:
        migrations.upgrade(context.database)
    typer.echo("The database is up to date.")


def backup(flags: dict[str, Any], out: Path) -> None:
    """Write a consistent copy of the database, also while the service runs. An existing file is not replaced."""
    if out.exists():
        output.fail(f"{out}: is there already", output.UNREADABLE)
    with opened(configure(flags)) as context:
        _require_tables(context.database, "back up")
        unfinished = out.with_name(f"{out.name}.part")
        try:
            unfinished.touch(ONLY_OWNER, exist_ok=False)
            _write_backup(context.database, unfinished)
            unfinished.rename(out)
        finally:
            unfinished.unlink(missing_ok=True)
    typer.echo(f"Backed up to {out}.")


def restore(flags: dict[str, Any], source: Path, replace: bool) -> None:
    """Put a backup in the place of the database, all or nothing, and bring it up to date. Stop the service before."""
    if not source.is_file():
        output.fail(f"{source}: no such file", output.UNREADABLE)
    with opened(configure(flags)) as context:
        if _has_tables(context.database) and not replace:
            output.fail("The database is in use; --replace gives up what is in it.", output.UNREADABLE)
        _read_backup(context.database, source)
        context.database.close()
        migrations.upgrade(context.database)
    typer.echo(f"Restored from {source}.")


def check(flags: dict[str, Any]) -> None:
    """Look for damage, also while the service runs; on PostgreSQL only for missing migrations (see `pg_amcheck`)."""
    with opened(configure(flags)) as context:
        _require_tables(context.database, "check")
        problems = _damage(context.database) if context.database.is_sqlite else []
        with context.database.read() as tx:
            if not migrations.is_newest(tx):
                problems.append("It is not of this version: `livella db migrate` brings it up to date.")
    if problems:
        output.fail("\n".join(problems))
    typer.echo("The database is sound.")


def _damage(database: Database) -> list[str]:
    with _sqlite(database) as live:
        found = [str(row[0]) for row in live.execute("PRAGMA integrity_check")]
        orphans = live.execute("PRAGMA foreign_key_check").fetchall()
    return [line for line in found if line != "ok"] + [f"{row[0]}: row {row[1]} belongs to nothing" for row in orphans]


def _has_tables(database: Database) -> bool:
    return sa.inspect(database.engine).has_table(VERSION_TABLE)


def _require_tables(database: Database, to_do: str) -> None:
    if not _has_tables(database):
        output.fail(f"There is nothing to {to_do}: the database is empty.", output.UNREADABLE)


def _write_backup(database: Database, out: Path) -> None:
    if not database.is_sqlite:
        _run_tool(database, "pg_dump", "--format=custom", "--no-owner", "--no-privileges", f"--file={out}")
        return
    with _sqlite(database) as live, closing(sqlite3.connect(out)) as copy:
        live.backup(copy)
        copy.execute("PRAGMA journal_mode = DELETE")  # a single file that can be carried away


def _read_backup(database: Database, source: Path) -> None:
    if not database.is_sqlite:
        options = ("--clean", "--if-exists", "--no-owner", "--no-privileges", "--single-transaction", "--exit-on-error")
        _run_tool(database, "pg_restore", *options, str(source))
        return
    with closing(sqlite3.connect(f"{source.absolute().as_uri()}?mode=ro", uri=True)) as copy, _sqlite(database) as live:
        _check(copy, source)
        copy.backup(live)


def _check(copy: sqlite3.Connection, source: Path) -> None:
    """Refuse a file that is no sound backup before anything is touched."""
    try:
        sound = copy.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        ours = copy.execute("SELECT 1 FROM sqlite_master WHERE name = ?", (VERSION_TABLE,)).fetchone()
    except sqlite3.DatabaseError:
        sound, ours = False, None
    if not (sound and ours):
        output.fail(f"{source}: expected a backup of a Livella database on SQLite", output.UNREADABLE)


@contextmanager
def _sqlite(database: Database) -> Iterator[sqlite3.Connection]:
    """Give the driver's own connection to the live database, which can copy page by page."""
    with closing(database.engine.raw_connection()) as pooled:
        connection = pooled.driver_connection
        if not isinstance(connection, sqlite3.Connection):
            raise TypeError("not a connection to SQLite")
        yield connection


def _run_tool(database: Database, tool: str, *options: str) -> None:
    """Run one of PostgreSQL's own programs; the password goes through the environment, where others cannot read it."""
    program = shutil.which(tool)
    if program is None:
        output.fail(f"{tool} is not installed; it comes with PostgreSQL's client programs.")
    url = database.url.set(drivername="postgresql", password=None).render_as_string()
    secret = {"PGPASSWORD": str(database.url.password)} if database.url.password else {}
    done = subprocess.run(  # noqa: S603 a program from the operator's own path, with arguments that are no shell's
        [program, f"--dbname={url}", *options], env=os.environ | secret, stderr=subprocess.PIPE, text=True, check=False
    )
    if done.returncode:
        output.fail(f"{tool} failed: {done.stderr.strip()}")
