"""Pages that several benchmarks write: each its own section, between marks, leaving the others as they are."""

from pathlib import Path


def marked(name: str, text: str) -> str:
    """Give a section with its marks."""
    return f"<!-- {name}: begin -->\n{text.strip()}\n<!-- {name}: end -->\n"


def with_section(page: str, name: str, text: str) -> str:
    """Give a page with a section in the place of the former one, or at the end."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    if begin not in page or end not in page:
        return f"{page.rstrip()}\n\n{marked(name, text)}".lstrip()
    before, _, rest = page.partition(begin)
    return before + marked(name, text) + rest.partition(end)[2]


def write_section(path: Path, name: str, text: str) -> None:
    """Write a section of a page."""
    page = path.read_text(encoding="utf-8") if path.exists() else ""
    path.write_text(with_section(page, name, text), encoding="utf-8")
