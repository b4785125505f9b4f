"""Pages of the documentation, taken apart into what a reader would type.

A fenced block counts by its language:

- ``console``: lines that start with ``$ `` are commands, the others are what they print.
- ``python``: code; all blocks of a page share their names. An ``output`` block behind it is what it prints.
- ``python`` or ``toml`` that begins with ``# NAME.py`` or ``# NAME.toml``: a file that the reader writes.

An HTML comment above a block changes how it is run:

- ``<!-- given ... -->``: code, and commands behind ``$ ``, to run first, for what the page takes as given.
- ``<!-- short: A => B -->``: A is replaced by B, so that it does not take minutes.
- ``<!-- skip: REASON -->``: it is not run.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted(
    [ROOT / "README.md", *(path for path in (ROOT / "docs").rglob("*.md") if "auto_gallery" not in path.parts)]
)

_FENCE = re.compile(r"^```(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NOTE = re.compile(r"<!-- (given|short|skip)\b:?(.*?)-->", re.DOTALL)
_FILE = re.compile(r"# ([\w.-]+\.(?:py|toml))\n")


@dataclass
class Block:
    """One thing to do: ``kind`` is command, code or file."""

    kind: str
    text: str
    line: int
    given: str = ""
    skip: str = ""
    output: str = ""
    short: list[tuple[str, str]] = field(default_factory=list)

    @property
    def run(self):
        """The text as it is run."""
        text = self.text
        for old, new in self.short:
            text = text.replace(old, new)
        return text


def name(page):
    """Path of a page from the root of the repository."""
    return str(page.relative_to(ROOT))


def fences(text):
    """Language, content and first line of every fenced block, and the comments above it."""
    end = 0
    for match in _FENCE.finditer(text):
        notes = [(kind, note.strip("\n")) for kind, note in _NOTE.findall(text[end : match.start()])]
        yield match[1], match[2], text[: match.start()].count("\n") + 2, notes
        end = match.end()


def blocks(page):
    """Everything on a page that a reader would do, in order."""
    found = []
    for language, text, line, notes in fences(page.read_text()):
        if language == "output":
            found[-1].output = text
            continue
        if language in ("python", "toml") and _FILE.match(text):
            new = [Block("file", text, line)]
        elif language == "python":
            new = [Block("code", text, line)]
        elif language == "console":
            new = _commands(text, line)
        else:
            continue
        for kind, note in notes:
            if kind == "given":
                new[0].given = note
            elif kind == "skip":
                for block in new:
                    block.skip = note.strip()
            else:
                old, _, short = note.strip().partition(" => ")
                meant = [block for block in new if old in block.text]
                assert meant, f"{page}:{line}: short form of {old!r}, which is not there"
                for block in meant:
                    block.short.append((old, short))
        found += new
    return found


def file_name(block):
    """Name of the file that a block is."""
    return _FILE.match(block.text)[1]


def _commands(text, line):
    found = []
    for number, row in enumerate(text.splitlines()):
        if row.startswith("$ "):
            found.append(Block("command", row[2:], line + number))
        else:
            assert found, f"line {line}: a console block begins with a command"
            found[-1].output += row + "\n"
    return found
