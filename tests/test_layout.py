"""The layout is what docs/architecture.md says: imports point down, and every file is named there."""

import ast
from pathlib import Path

import pytest

import vasculo

ROOT = Path(vasculo.__file__).parent
ARCHITECTURE = Path(__file__).parents[1] / "docs" / "architecture.md"
FLOORS = [
    {"geometry", "springs"},
    {"mesh"},
    {"tissue", "plexus"},
    {"flow"},
    {"pillars", "measure"},
    {"store"},
    {"draw", "view"},
    {"study"},
    {"cli"},
]
FLOOR = {name: floor for floor, names in enumerate(FLOORS) for name in names}
FILES = sorted(path for path in ROOT.rglob("*.py") if path.parent != ROOT)


def imported(path):
    """Folders of vasculo that a file imports from."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module == "vasculo":
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith("vasculo."):
            yield node.module.split(".")[1]
        elif isinstance(node, ast.Import):
            yield from (alias.name.split(".")[1] for alias in node.names if alias.name.startswith("vasculo."))


@pytest.mark.parametrize("path", FILES, ids=lambda path: str(path.relative_to(ROOT)))
def test_imports_point_down(path):
    here = FLOOR[path.relative_to(ROOT).parts[0]]
    above = {name for name in imported(path) if name in FLOOR and FLOOR[name] > here}
    assert not above, f"{path.relative_to(ROOT)} imports from {sorted(above)}"


def test_every_file_is_on_the_page_and_the_page_names_no_other():
    text = ARCHITECTURE.read_text()
    sections = {part.split("/`", 1)[0]: part for part in text.split("### `")[1:]}
    listed = {
        f"{folder}/{line.split('`')[1]}"
        for folder, part in sections.items()
        for line in part.splitlines()
        if line.startswith("- `")
    }
    there = {str(path.relative_to(ROOT)) for path in FILES if path.name != "__init__.py"}
    assert listed == there


def test_no_file_is_longer_than_four_hundred_lines():
    assert not [path.name for path in FILES if len(path.read_text().splitlines()) > 400]


def test_public_names_are_all_there():
    missing = [name for name in vasculo.__all__ if not hasattr(vasculo, name)]
    assert not missing
