"""The command line. Each command loads what it needs when it is called, so that help comes at once."""

from vasculo.cli import studies, measure, draw, report, image, view, sweep, match  # noqa: F401, I001  # in the order of the help
from vasculo.cli.app import app, main

__all__ = ["app", "main"]
