"""`fpsolve string`: spin a fibre from a nozzle, and lay it on a belt."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from fpsolve.cli.command import command_line
from fpsolve.cli.console import print_lines, print_pairs
from fpsolve.cli.frame import Frame, command
from fpsolve.cli.options import NoFigures, Out

if TYPE_CHECKING:
    from fpsolve.cli.config.string import StringConfig
    from fpsolve.fibre.ends import Belt
    from fpsolve.fibre.laid import LayDown
    from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = ["string"]

_OF_FILE = "of the file"
Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file with sections [fibre], [nozzle], [belt], [air], [turbulence] "
        "and [steps]; without it the packaged example.",
    ),
]
End = Annotated[
    float | None,
    typer.Option(help="Seconds to spin for.", metavar="T", show_default=_OF_FILE),
]
Steps = Annotated[
    int | None, typer.Option(help="Number of steps.", show_default=_OF_FILE)
]
Seed = Annotated[
    int | None,
    typer.Option(help="Seed of the turbulence.", min=0, show_default=_OF_FILE),
]


def string(
    config: Config = None,
    out: Out = Path("results"),
    t_end: End = None,
    n_steps: Steps = None,
    seed: Seed = None,
    no_figures: NoFigures = False,
) -> None:
    """Spin a fibre from a nozzle into the air, and lay it on a moving belt.

    In SI units. Prints what lies on the belt and how well the steps keep the fibre's
    length; writes the run, the curve on the belt, which `fpsolve identify` takes, and
    a figure.
    """
    with command(out, figures=not no_figures) as frame:
        from fpsolve.plotting.fibre_motion import plot_lay_down

        keys = {"t_end": t_end, "n_steps": n_steps, "seed": seed}
        chosen = _config(config).changed("steps", **keys)
        name = chosen.output.name
        frame.figures = chosen.output.figures and not no_figures
        frame.claim(chosen.output.file_name, f"{name}.png", f"{name}-curve.nc")
        found = _laid(frame, chosen, f"{name}-checkpoint.nc")
        used = command_line(
            "string", *([] if config is None else [str(config)]), **keys
        )
        about = {**found.provenance, "configuration": chosen.to_toml(), **used}
        print_lay_down(found)
        frame.finish(replace(found, provenance=about), chosen.output.file_name)
        _write_curve(frame, found, chosen)
        frame.figure(plot_lay_down, found, name=f"{name}.png")


def print_lay_down(found: LayDown) -> None:
    """Print what was spun, what lies, and what the steps kept."""
    nozzle, error = found.nozzle, found.position_error
    print_pairs([
        ("spun", f"{found.fed:.4g} m at {nozzle.speed:g} m/s in {found.t[-1]:g} s"),
        ("belt", _belt(found.belt)),
        ("in the air", f"{found.free_length[-1]:.4g} m"),
        ("tension", f"{found.largest_tension.max():.3g} N at most"),
        ("at the nozzle", f"{found.nozzle_tension[1:].mean():.3g} N on average"),
        ("steps", f"{found.t.size - 1}, {found.iterations[1:].mean():.3g} iterations "
                  f"each, {int(found.rejected.sum())} in halves"),
        ("edges", f"keep their length to {found.stretched.max():.1e}"),
        ("position error",
         f"{error:.2g} m" if math.isfinite(error) else "not estimated"),
    ])  # fmt: skip


def _belt(belt: Belt | None) -> str:
    """Its speed, and its friction if there is a limit to it."""
    if belt is None:
        return "none"
    rubs = f", friction {belt.friction:g}" if math.isfinite(belt.friction) else ""
    return f"{belt.speed:g} m/s{rubs}"


def _laid(frame: Frame, chosen: StringConfig, kept: str) -> LayDown:
    """The fibre; what is interrupted is kept, and gone on with."""
    from fpsolve.fibre.laying import lay_down

    problem, checkpoint = chosen.build(), frame.out / kept
    frame.claim(kept)
    said = f"the same command goes on from `{checkpoint}`"
    with frame.computing(kept=said) as report:

        def begun(n_done: int, n_total: int, t: float) -> None:
            # Not before a step was found: a mistake leaves no folder.
            frame.path(kept)
            report(n_done, n_total, t)

        return lay_down(
            problem.string, **problem.arguments, progress=begun, checkpoint=checkpoint
        )


def _write_curve(frame: Frame, found: LayDown, chosen: StringConfig) -> None:
    """The curve on the belt; or say why there is none."""
    name = f"{chosen.output.name}-curve.nc"
    if found.belt is None:
        return
    try:
        curve: FibreCurve = found.laid_curve(skip=chosen.steps.skip)
    except ValueError as error:
        print_lines(f"no curve on the belt: {error}")
        return
    print_pairs([("on the belt", f"{curve.length:.4g} m, every {curve.ds:g} m")])
    frame.finish(curve, name)


def _config(path: Path | None) -> StringConfig:
    from fpsolve.cli.config.reading import STRING_EXAMPLE, example_path, load_config
    from fpsolve.cli.config.string import StringConfig

    return load_config(path or example_path(STRING_EXAMPLE), StringConfig)
