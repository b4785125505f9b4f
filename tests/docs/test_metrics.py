"""The page of every number is that of the code, and names every number."""

import csv
import dataclasses

from benchmarks.metrics_page import PAGE, page

from vasculo import measure
from vasculo.store.table import COLUMNS


def test_the_page_is_as_the_code_says():
    assert PAGE.read_text() == page(), "run: python benchmarks/metrics_page.py"


def test_every_number_is_named(tour):
    text = PAGE.read_text()
    wanted = set(COLUMNS)
    for name in measure.__all__:
        thing = getattr(measure, name)
        if dataclasses.is_dataclass(thing):
            wanted |= {field.name for field in dataclasses.fields(thing)}
    _, _, folder = tour
    with (folder / "runs" / "small" / "metrics.csv").open() as file:
        wanted |= set(next(csv.reader(file)))
    assert not {name for name in wanted if f"`{name}`" not in text}
