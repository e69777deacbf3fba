"""The command line: `fpsolve run`, `paths`, `check`, `rate`, `spectrum`, `plot`, …

Whatever takes long to import is imported by the command that needs it, so that
``fpsolve --help`` answers at once.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import typer

from fpsolve.cli.check import check
from fpsolve.cli.compare import compare
from fpsolve.cli.design import design
from fpsolve.cli.energy import energy
from fpsolve.cli.identify import identify
from fpsolve.cli.info import info
from fpsolve.cli.limits import limits
from fpsolve.cli.paths import paths
from fpsolve.cli.plot import plot
from fpsolve.cli.predict import predict
from fpsolve.cli.rate import rate
from fpsolve.cli.report import report
from fpsolve.cli.rerun import rerun
from fpsolve.cli.resume import resume
from fpsolve.cli.run import run
from fpsolve.cli.spectrum import spectrum
from fpsolve.cli.string import string
from fpsolve.cli.web import web

__all__ = ["app", "main"]

app = typer.Typer(
    name="fpsolve",
    help="Solve the Fokker-Planck equation of stochastic fibre lay-down.",
    epilog="Example: fpsolve run --out results",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
# Every command with an example of its use.
_COMMANDS: dict[Callable[..., None], str] = {
    run: "run --example spunbond --out results",
    resume: "resume results/laydown.checkpoint",
    paths: "paths --n-paths 10000 --out results",
    check: "check --n-paths 100000 --out results",
    rate: "rate --quick --out results",
    spectrum: "spectrum --potential linear --noise 0.8",
    energy: "energy --noise 0.3 --passage 0.1 0.5",
    limits: "limits small-noise --quick",
    web: "web --out results",
    predict: "predict --noise 2 --belt-speed 0.2 --spacing 0.5",
    design: "design --out results",
    string: "string --out results",
    identify: "identify fibre.csv --belt-speed 0.1 --ds 1e-3",
    plot: "plot results/laydown.nc --movie",
    report: "report results/laydown.nc",
    rerun: "rerun results/laydown.nc --out again",
    compare: "compare results/a.nc results/b.nc",
    info: "info",
}
for _command, _example in _COMMANDS.items():
    app.command(epilog=f"Example: fpsolve {_example}")(_command)


def _show_version(wanted: bool) -> None:
    if wanted:
        from fpsolve._support.provenance import versions

        typer.echo(versions()["fpsolve"])
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version",
            callback=_show_version,
            is_eager=True,
            help="Print the version and exit.",
        ),
    ] = False,
) -> None:
    """Take the options that come before a command."""


def main() -> None:
    """Run the command line; the exit code is 2 for bad input, 1 for a failed run."""
    app(prog_name="fpsolve")
