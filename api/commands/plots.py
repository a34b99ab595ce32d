"""Pictures that commands draw, with matplotlib if it is there."""

import importlib
from pathlib import Path
from typing import Any

from api.commands import output

ENDINGS = (".pdf", ".png", ".svg")


def new_figure(path: Path) -> Any:
    """Give an empty figure for this file; when it cannot be drawn, say why and end with status 2."""
    if path.suffix.lower() not in ENDINGS:
        output.fail(f"{path}: a picture ends in {', '.join(ENDINGS[:-1])} or {ENDINGS[-1]}", output.UNREADABLE)
    try:
        module = importlib.import_module("matplotlib.figure")
    except ImportError:
        output.fail("--plot needs matplotlib: pip install 'livella[plot]'", output.UNREADABLE)
    return module.Figure(figsize=(9.0, 7.0), layout="constrained")


def save(figure: Any, path: Path) -> None:
    """Write the picture."""
    try:
        figure.savefig(path)
    except OSError as error:
        output.fail(f"{path}: {error.strerror or error}", output.UNREADABLE)
