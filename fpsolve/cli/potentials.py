"""Potentials from options of the command line, declared once for every command."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import asdict, dataclass
from functools import wraps
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.options import CONFINING, proposing

if TYPE_CHECKING:
    from fpsolve.model.potentials.potential import Potential

__all__ = ["PARAMETERS", "Kind", "Kinds", "Noise", "Parameters", "with_parameters"]


def _kind(end: str = ".", **options: Any) -> Any:
    words = f"{', '.join(CONFINING[:-1])} or {CONFINING[-1]}{end}"
    options |= {"metavar": "KIND", "autocompletion": proposing(*CONFINING)}
    return typer.Option("--potential", help=words, **options)


Kind = Annotated[str, _kind()]
Kinds = Annotated[
    list[str] | None,
    _kind("; may be given several times.", show_default="quadratic and linear"),
]
Noise = Annotated[float, typer.Option(metavar="A", help="Noise amplitude.")]


@dataclass(frozen=True)
class Parameters:
    """Parameters of potentials, under their names; each kind has its own."""

    sigma1: Annotated[
        float, typer.Option(help="Throwing range σ1 of a quadratic potential.")
    ] = 1.0
    sigma2: Annotated[
        float | None,
        typer.Option(help="Throwing range σ2 across the belt.", show_default="σ1"),
    ] = None
    slope: Annotated[
        float, typer.Option(help="Slope K of a linear potential K|ξ|.")
    ] = 1.0
    exponent: Annotated[
        float, typer.Option(help="Exponent n of a power potential |ξ|ⁿ/n.")
    ] = 4.0

    def make(self, kind: str) -> Potential:
        """Return the potential of a kind, with the parameters that belong to it."""
        from fpsolve.model.potentials.dictionaries import KINDS

        if kind not in KINDS:
            known = ", ".join(KINDS)
            raise ValueError(f"`--potential` must be one of {known}, got {kind!r}.")
        given = asdict(self)
        if self.sigma2 is None:
            given["sigma2"] = self.sigma1
        own = inspect.signature(KINDS[kind]).parameters.keys() & given.keys()
        return KINDS[kind](**{name: given[name] for name in own})


PARAMETERS = Parameters()


def with_parameters(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the parameters of potentials as options.

    They stand in the place of its argument `parameters`, which it is called with.
    """
    own = inspect.signature(Parameters, eval_str=True).parameters
    shown: list[inspect.Parameter] = []
    for one in inspect.signature(command, eval_str=True).parameters.values():
        shown += own.values() if one.name == "parameters" else [one]

    @wraps(command)
    def called(**given: Any) -> None:
        parameters = Parameters(**{name: given.pop(name) for name in own})
        command(**given, parameters=parameters)

    # What typer reads.
    called.__signature__ = inspect.Signature(shown)  # type: ignore[attr-defined]
    called.__annotations__ = {one.name: one.annotation for one in shown}
    return called
