"""Statements of the path of an upload, translated once: the driver gets them without a detour.

SQLAlchemy looks up, checks and wraps for every execution, several times as long as a database takes for a row found by
its key. A prepared statement keeps the text and the types' converters that SQLAlchemy made for it; errors are its own.
"""

import re
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import sqlalchemy as sa
from sqlalchemy.engine import Connection, Dialect

on_error: list[Callable[[Exception], None]] = []
"""Told of every error, as SQLAlchemy's event `handle_error` tells of those of all other statements."""
_Convert = Callable[[Any], Any] | None
_OPTIONS: dict[str, dict[str, Any]] = {"postgresql": {"binary": True}}
"""of the drivers: PostgreSQL's would write the estimator's state as text otherwise"""
_FLOAT8 = 701
"""PostgreSQL's number of the only type for whose values SQLAlchemy wants to know what the server calls it"""
_Parameters = Sequence[Any] | dict[str, Any]


class _Translated(NamedTuple):
    """A statement as the driver takes it."""

    sql: str
    by_place: bool
    """the driver takes parameters by place, not by name"""
    parameters: tuple[tuple[str, Any, _Convert], ...]
    """name, value where none is given, converter; in the order of their places"""
    results: tuple[tuple[int, Callable[[Any], Any]], ...]
    """place and converter of the columns that have one"""

    def bind(self, values: dict[str, Any]) -> _Parameters:
        """Give the parameters as the driver takes them."""
        bound = [
            values.get(name, constant) if convert is None else convert(values.get(name, constant))
            for name, constant, convert in self.parameters
        ]
        if self.by_place:
            return bound
        return {name: value for (name, _, _), value in zip(self.parameters, bound, strict=True)}

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
        self.table = None if isinstance(statement, sa.Select) else statement.table
        """that an INSERT or UPDATE changes"""
        self._translated: dict[tuple[str, ...], _Translated] = {}

    def rows(self, connection: Connection, values: dict[str, Any]) -> Sequence[Sequence[Any]]:
        """Run it in the connection's transaction and give the rows, if it gives any."""
        form = self.translated(connection, values)
        found = execute(connection, form.sql, form.bind(values), reads=self.table is None)
        return [form.shape(row) for row in found]

    def translated(self, connection: Connection, values: dict[str, Any]) -> _Translated:
        """Give it as the driver takes it with these values."""
        form = self._translated.get(key := (connection.dialect.name, *values))
        if form is None:
            form = self._translated[key] = _translate(self.statement, connection.dialect, tuple(values))
        return form


Run = tuple[Prepared, dict[str, Any]]
"""A statement to be run, with its values."""
_combined: dict[tuple[str, ...], str] = {}
"""texts of statements that go together, by those of each"""
_PARAMETER = re.compile(r"%\((\w+)\)s")


def run_all(connection: Connection, runs: Sequence[Run]) -> None:
    """Run INSERTs and UPDATEs of a row each, of which no two have the same table.

    PostgreSQL gets them as one statement: a way there and back costs more than to insert a row.
    """
    if connection.dialect.name != "postgresql" or len(runs) < 2:
        for statement, values in runs:
            statement.rows(connection, values)
        return
    texts: list[str] = []
    bound: dict[str, Any] = {}
    for place, (statement, values) in enumerate(runs):
        form = statement.translated(connection, values)
        texts.append(form.sql)
        bound |= {f"{name}_{place}": value for name, value in dict(form.bind(values)).items()}
    execute(connection, _combine(tuple(texts)), bound)


def _combine(texts: tuple[str, ...]) -> str:
    """Give one statement for several; the last of them is the main one."""
    if texts not in _combined:
        own = [_PARAMETER.sub(rf"%(\1_{place})s", text) for place, text in enumerate(texts)]
        parts = ", ".join(f"part_{place} AS ({text})" for place, text in enumerate(own[:-1]))
        _combined[texts] = f"WITH {parts} {own[-1]}"
    return _combined[texts]


def execute(connection: Connection, sql: str, parameters: _Parameters = (), reads: bool = False) -> list[Any]:
    """Give the driver a statement of the connection's transaction, and the rows if it is one that reads."""
    driver: Any = connection.connection.dbapi_connection
    try:
        cursor = driver.execute(sql, parameters, **_OPTIONS.get(connection.dialect.name, {}))
        found: list[Any] = cursor.fetchall() if reads else []
    except connection.dialect.loaded_dbapi.Error as error:
        raise _wrapped(connection, sql, error) from error
    return found


def _wrapped(connection: Connection, sql: str, error: Any) -> BaseException:
    """Give SQLAlchemy's error for one of the driver; a connection that has broken is not used again."""
    dialect = connection.dialect
    is_lost = dialect.is_disconnect(error, connection.connection.dbapi_connection, None)
    wrapped: BaseException = sa.exc.DBAPIError.instance(
        sql,
        None,  # what was sent may be secret, and errors are logged
        error,
        dialect.loaded_dbapi.Error,
        hide_parameters=True,
        connection_invalidated=is_lost,
        dialect=dialect,
    )
    if isinstance(wrapped, Exception):
        for told in on_error:
            told(wrapped)
    if is_lost:
        connection.invalidate(error)
    return wrapped


def _translate(statement: Any, dialect: Dialect, names: Sequence[str]) -> _Translated:
    compiled = statement.compile(dialect=dialect, column_keys=None if statement.is_select else list(names))
    by_place = compiled.positiontup is not None
    named = {name: parameter for parameter, name in compiled.bind_names.items()}
    places = [
        (name, compiled.params[name], named[name].type.dialect_impl(dialect).bind_processor(dialect))
        for name in (compiled.positiontup if by_place else named)
    ]
    columns = statement.selected_columns if statement.is_select else ()
    results = [column.type.dialect_impl(dialect).result_processor(dialect, _FLOAT8) for column in columns]
    converted = tuple((place, convert) for place, convert in enumerate(results) if convert is not None)
    return _Translated(str(compiled), by_place, tuple(places), converted)
