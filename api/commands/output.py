"""What commands write to the terminal: errors and progress to stderr, results to stdout."""

from collections.abc import Collection, Iterable
from typing import NoReturn

import numpy as np
import typer
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn
from rich.table import Table
from rich.text import Text

import core
from api.services import plain

FAILED = 1
"""exit status when the service refused or could not be reached"""
UNREADABLE = 2
"""exit status when a file or an argument cannot be used"""

ANGLES = ("roll", "pitch", "yaw")
PIPE_WIDTH = 160
"""columns of a table that goes into a file or another program"""


def fail(message: str, status: int = FAILED) -> NoReturn:
    """End the command with a message."""
    complain(message)
    raise typer.Exit(status)


def complain(message: str) -> None:
    """Say on stderr what is wrong."""
    typer.echo(message, err=True)


def print_table(heads: Iterable[str], rows: Iterable[Iterable[str]], folded: Collection[str] = ()) -> None:
    """Print a table, where it is too wide with some columns folded. Cells are no markup, and steer no terminal."""
    table = Table(box=SIMPLE_HEAD, pad_edge=False, collapse_padding=True)
    for head in heads:
        table.add_column(head, no_wrap=head not in folded, overflow="fold")
    for row in rows:
        table.add_row(*(Text(plain.one_line(cell)) for cell in row))
    stdout().print(table)


def stdout() -> Console:
    """Give the console for results."""
    console = Console()
    return console if console.is_terminal else Console(width=PIPE_WIDTH)


def progress() -> Progress:
    """Give a progress bar on stderr, shown on a terminal only; its total is in seconds of log time."""
    console = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn("{task.completed:.0f}/{task.total:.0f} s"),
        TimeRemainingColumn(),
        console=console,
        disable=not console.is_terminal,
        transient=True,
    )


def angles(quaternion: Iterable[float], sigma_deg: Iterable[float]) -> list[str]:
    """Give roll, pitch and yaw of a mounting for people, each such as "-1.2 ±0.3", degrees."""
    degrees = np.degrees(core.quaternion.angles(list(quaternion)))
    return [f"{angle:.1f} ±{sigma:.1f}" for angle, sigma in zip(degrees, sigma_deg, strict=True)]
