"""Statements of the path of an upload, translated once: on SQLite the driver gets them without a detour.

SQLAlchemy looks up, checks and wraps for every execution, five times as long as SQLite takes for a row found by its
key. A prepared statement keeps the text and the types' converters that SQLAlchemy made for it; errors are its own.
"""

import sqlite3
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Dialect

on_error: list[Callable[[Exception], None]] = []
"""Told of every error, as SQLAlchemy's event `handle_error` tells of those of all other statements."""
_Convert = Callable[[Any], Any] | None


class _Translated(NamedTuple):
    """A statement as the driver takes it."""

    sql: str
    parameters: tuple[tuple[str, Any, _Convert], ...]
    """name, value where none is given, converter"""
    results: tuple[tuple[int, Callable[[Any], Any]], ...]
    """place and converter of the columns that have one"""

    def bind(self, values: dict[str, Any]) -> list[Any]:
        """Give the parameters in the order of their places."""
        return [
            values.get(name, constant) if convert is None else convert(values.get(name, constant))
            for name, constant, convert in self.parameters
        ]

    def shape(self, row: Sequence[Any]) -> tuple[Any, ...]:
        """Give the values of a row as their columns' types have them."""
        shaped = list(row)
        for place, convert in self.results:
            shaped[place] = convert(shaped[place])
        return tuple(shaped)


class Prepared:
    """A statement built once, with plain parameters: none that stands for a list, no defaults made in Python."""

    def __init__(self, statement: sa.Select[Any] | sa.Insert | sa.Update) -> None:
        self.statement = statement
        self._translated: dict[tuple[str, ...], _Translated] = {}

    def rows(self, connection: Connection, values: dict[str, Any]) -> Sequence[Sequence[Any]]:
        """Run it in the connection's transaction and give the rows, if it gives any."""
        if connection.dialect.name != "sqlite":
            result = connection.execute(self.statement, values)
            return result.all() if result.returns_rows else ()
        form = self._translated.get(names := tuple(values))
        if form is None:
            form = self._translated[names] = _translate(self.statement, connection.dialect, names)
        return [form.shape(row) for row in execute(connection, form.sql, form.bind(values))]


def execute(connection: Connection, sql: str, parameters: Sequence[Any] = ()) -> list[Any]:
    """Give SQLite's driver a statement of the connection's transaction, and the rows that it gives."""
    driver: Any = connection.connection.dbapi_connection
    try:
        found: list[Any] = driver.execute(sql, parameters).fetchall()
    except sqlite3.Error as error:
        wrapped = sa.exc.DBAPIError.instance(sql, tuple(parameters), error, sqlite3.Error, dialect=connection.dialect)
        for told in on_error:
            told(wrapped)
        raise wrapped from error
    return found


def _translate(statement: Any, dialect: Dialect, names: Sequence[str]) -> _Translated:
    compiled = statement.compile(dialect=dialect, column_keys=None if statement.is_select else list(names))
    places = [
        (name, compiled.params[name], compiled.binds[name].type.dialect_impl(dialect).bind_processor(dialect))
        for name in compiled.positiontup or ()
    ]
    columns = statement.selected_columns if statement.is_select else ()
    results = [column.type.dialect_impl(dialect).result_processor(dialect, None) for column in columns]
    converted = tuple((place, convert) for place, convert in enumerate(results) if convert is not None)
    return _Translated(str(compiled), tuple(places), converted)
