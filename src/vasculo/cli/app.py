"""The command line itself: how a command that goes wrong ends, in one line and with its exit code."""

from __future__ import annotations

import functools
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from vasculo.errors import ComputationError, InputError

if TYPE_CHECKING:
    from collections.abc import Callable

BAD_INPUT, FAILED, INTERRUPTED = 2, 1, 130

app = typer.Typer(
    name="vasculo",
    help="How small blood vessels form, mechanically: vasculogenesis, plexus flow and angiogenesis of one tissue.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.", show_default=False)]
Assignments = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Replace a value, as angiogenesis.steps=10.")
]


def one_line(command: Callable[..., None]) -> Callable[..., None]:
    """End a command that goes wrong with one line and its exit code."""

    @functools.wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:  # whatever the command takes
        try:
            command(*args, **kwargs)
        except InputError as error:
            stop(error, BAD_INPUT)
        except ComputationError as error:
            stop(error, FAILED)
        except MemoryError as error:
            stop(f"not enough memory ({error}): use fewer nodes or pillars, or longer edges", FAILED)
        except OSError as error:
            named = error.filename is not None and error.strerror
            stop(f"{error.filename}: {error.strerror}" if named else error, FAILED)
        except KeyboardInterrupt as error:
            stop(error or "interrupted", INTERRUPTED)

    return guarded


def stop(message: object, code: int) -> NoReturn:
    """Print one line and exit."""
    typer.echo(f"vasculo: {' '.join(str(message).split()) or 'interrupted'}", err=True)
    raise typer.Exit(code)


def main() -> None:
    """Run the command line; a wrong option ends in one line too."""
    try:
        code = app(standalone_mode=False)
    except KeyboardInterrupt:
        typer.echo("vasculo: interrupted", err=True)
        code = INTERRUPTED
    except Exception as error:
        told = getattr(error, "format_message", None)
        if told is None:
            raise
        if message := " ".join(told().replace("Value error, ", "").split()):
            typer.echo(f"vasculo: {message} (see vasculo --help)", err=True)
        code = BAD_INPUT
    sys.exit(code)
