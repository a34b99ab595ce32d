"""Bring a database to the newest version of the tables; safe when several processes start at once."""

from importlib.resources import files

import sqlalchemy as sa
from alembic import command
from alembic.config import Config
from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy.engine import Connection
from sqlalchemy.exc import OperationalError
from tenacity import retry, retry_if_exception_type, stop_after_delay, wait_random

from storage.database import Database, ReadSession, WriteSession

MIGRATION_LOCK = 0x6C6976656C6C61
"""Number of the advisory lock that PostgreSQL holds during a migration ("livella")."""


def upgrade(database: Database) -> None:
    """Apply the migrations that are missing, in one transaction: a crash leaves the old version or the new one."""
    if database.is_sqlite:
        _use_write_ahead_log(database)
    with database.write() as tx:
        lock(tx)
        command.upgrade(config(tx.connection), "head")


def lock(tx: WriteSession) -> None:
    """Make every other process that calls this wait until this transaction ends."""
    if tx.is_postgresql:
        tx.connection.execute(sa.select(sa.func.pg_advisory_xact_lock(MIGRATION_LOCK)))


def is_newest(tx: ReadSession) -> bool:
    """Tell whether no migration is missing."""
    current = MigrationContext.configure(tx.connection).get_current_heads()
    return set(current) == set(ScriptDirectory.from_config(config()).get_heads())


def config(connection: Connection | None = None) -> Config:
    """Alembic's configuration: the migrations shipped in the package `migrations`, on a connection given."""
    made = Config()
    made.set_main_option("script_location", str(files("migrations")))
    made.attributes["connection"] = connection
    return made


@retry(
    retry=retry_if_exception_type(OperationalError),
    stop=stop_after_delay(30),
    wait=wait_random(0.01, 0.1),
    reraise=True,
)
def _use_write_ahead_log(database: Database) -> None:
    """Switch the file to WAL, which it remembers; SQLite refuses at once while another process does the same."""
    connection = database.engine.raw_connection()
    try:
        connection.cursor().execute("PRAGMA journal_mode = WAL")
    finally:
        connection.close()
