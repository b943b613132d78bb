"""The command `thermobearing`: thin calls into the library, clear ends.

Exit status: 0 done; 1 a row of `verify` is red; 2 bad input or a target that cannot be written
(one message, nothing written; `intake` writes what it could read); 3 the analysis ended early
(partial results written); 4 a poor fit (written, the bearing marked); 130 interrupted (partial
results kept).
Heavy imports wait until a command needs them, so that --help is quick.
"""

import os
import sys
import warnings
from typing import Annotated

import typer

import thermobearing
from thermobearing.border.threads import one_blas_thread, reserve_blas
from thermobearing.commands import (  # noqa: F401 (each adds its commands)
    cyclic,
    design,
    earthquake,
    files,
    identify,
    intake,
    motions,
    start,
    study,
)
from thermobearing.commands.common import BAD_INPUT, app, guard_streams, is_out_of_memory

# Commands and groups in the order of the help.
ORDER = """start list check cyclic bridge hybrid sequence serve measure intake identify validate
design bounds lambda factors new verify live report study motions structures limits"""
NO_MEMORY = b"thermobearing: not enough memory\n"
app.registered_commands.sort(key=lambda command: ORDER.split().index(str(command.name)))
app.registered_groups.sort(key=lambda group: ORDER.split().index(str(group.name)))


def _version(requested: bool) -> None:
    if requested:
        typer.echo(f"thermobearing {thermobearing.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Show the version.")
    ] = False,
) -> None:
    """Rubber isolation bearings in the cold."""


def main() -> None:
    """Entry point of the console script."""
    one_blas_thread()
    guard_streams()
    warnings.formatwarning = lambda message, *_: f"thermobearing: warning: {message}\n"
    os.environ.pop("MPLBACKEND", None)  # all is drawn without a window; a wrong one ends imports
    try:
        lack = reserve_blas()
        if lack:
            typer.echo(f"thermobearing: {lack}", err=True)
            sys.exit(BAD_INPUT)
        epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")
        if not (epoch.isascii() and epoch.isdecimal()):
            typer.echo(
                f"thermobearing: SOURCE_DATE_EPOCH={epoch}: must be an integer number of seconds",
                err=True,
            )
            sys.exit(BAD_INPUT)
        app()
    except RuntimeError as problem:
        from thermobearing.core.compiled.runners import MissingKernelsError

        if not isinstance(problem, MissingKernelsError):
            raise
        typer.echo(f"thermobearing: {problem}", err=True)
        sys.exit(BAD_INPUT)
    except (MemoryError, SystemError) as problem:
        if not is_out_of_memory(problem):
            raise
        os.write(2, NO_MEMORY)  # no other way to write is certain to need no memory
        sys.exit(BAD_INPUT)
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.flush()
        write_error = getattr(sys.stdout, "lost", "")
        if write_error:
            typer.echo(f"thermobearing: the output could not be written: {write_error}", err=True)
            sys.exit(BAD_INPUT)


if __name__ == "__main__":
    main()
