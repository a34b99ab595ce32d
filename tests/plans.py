"""How a database goes about statements."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import sqlalchemy as sa
from sqlalchemy import event

from storage import prepared
from storage.database import ReadSession

NO_TABLES = ("SCAN CONSTANT ROW", "SCAN some")
READS_ALL = ("Seq Scan on", "SCAN ")
EXPLAINED = ("SELECT", "INSERT", "UPDATE", "DELETE", "WITH")
Statement = tuple[str, Any]
"""its text, and the values of its parameters"""
WAYS: tuple[dict[str, int], ...] = (
    {},  # a filter begins the search
    {"FEW": 0},  # it is made a set of, and a text is looked up where another filter leaves few devices
    {"FEW": 0, "SOME": 0},  # a text is made a set of too
    {"FEW": 0, "SOME": 0, "MANY": 0},  # everything is looked up
)
"""Numbers of `storage.device_lists`, so that few devices are found as many are."""


@contextmanager
def statements(of: sa.Connection | type[sa.Engine]) -> Iterator[list[Statement]]:
    """Note the statements that run in the block, those that have a plan."""
    ran: list[Statement] = []

    def note(_connection: object, _cursor: object, statement: str, values: Any, *_rest: object) -> None:
        if statement.startswith(EXPLAINED):
            ran.append((statement, values[0] if isinstance(values, list) else values))

    def execute(
        connection: sa.Connection, sql: str, parameters: Sequence[Any] | dict[str, Any] = (), reads: bool = False
    ) -> list[Any]:
        note(connection, None, sql, parameters if isinstance(parameters, dict) else tuple(parameters))
        return straight(connection, sql, parameters, reads)

    straight, prepared.execute = prepared.execute, execute
    event.listen(of, "before_cursor_execute", note)
    try:
        yield ran
    finally:
        event.remove(of, "before_cursor_execute", note)
        prepared.execute = straight


def explain(tx: ReadSession, statement: Statement) -> list[str]:
    """Give the steps of a statement, without doing them."""
    text, values = statement
    explain_here = "EXPLAIN (COSTS OFF)" if tx.is_postgresql else "EXPLAIN QUERY PLAN"
    return [str(row[-1]) for row in tx.connection.exec_driver_sql(f"{explain_here} {text}", values)]


def reads_whole_tables(steps: list[str]) -> list[str]:
    """Give the steps that read every row of a table; reading an index in its order, until enough is found, is none."""
    begins = [step.strip().removeprefix("->").strip() for step in steps]
    return [step for step in begins if step.startswith(READS_ALL) and "USING" not in step and step not in NO_TABLES]
