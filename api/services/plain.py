"""Texts from outside, made harmless for whatever shows them line by line."""


def one_line(text: str, longest: int | None = None) -> str:
    r"""Show what would not print, line breaks, escapes and marks of direction among it, as `\x1b` and the like."""
    shown = text if text.isprintable() else "".join(map(_printable, text))
    return shown[:longest]


def _printable(character: str) -> str:
    return character if character.isprintable() else character.encode("unicode_escape").decode()
