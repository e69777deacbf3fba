"""`fpsolve web`: lay the web that a configuration or options describe."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from fpsolve.cli.frame import Frame, command
from fpsolve.cli.identified import (
    From,
    read_identification,
    tables_of_identification,
)
from fpsolve.cli.options import (
    EXPORTS,
    PHASES,
    POSITIONS,
    NoFigures,
    Out,
    Threads,
    proposing,
    set_threads,
)
from fpsolve.cli.potentials import PARAMETERS, Kind, Noise, Parameters, with_parameters

if TYPE_CHECKING:
    from fpsolve.cli.config.web import WebConfig

__all__ = [
    "BeltSpeed",
    "RelaxationLength",
    "Spacing",
    "options_of_model",
    "tables_of",
    "web",
]

_OF_FILE = "of the file"
# What belongs to a model without units, which stands in the place of a file.
_MODEL = (
    "potential", "noise", "belt_speed", "relaxation_length",
    "sigma1", "sigma2", "slope", "exponent",
)  # fmt: skip
# The window of such a model in throwing ranges, where none is given.
_WINDOW = {"width": 20.0, "length": 20.0, "pixel": 0.1, "spacing": 0.1}


def _key(text: str, **options: Any) -> Any:
    return typer.Option(help=text, show_default=_OF_FILE, **options)


Config = Annotated[
    Path | None,
    typer.Argument(
        metavar="CONFIG.toml",
        help="TOML file with a section [web]; without it the packaged example in SI "
        "units, or what options of the model say.",
    ),
]
BeltSpeed = Annotated[
    float, typer.Option(metavar="V", help="Belt speed / spinning speed.")
]
RelaxationLength = Annotated[
    float | None,
    typer.Option(
        metavar="R", help="Of a smooth fibre's curvature.", show_default="basic model"
    ),
]
Length = Annotated[float | None, _key("Length of the window along the belt.")]
Width = Annotated[float | None, _key("Width of the window across the belt.")]
Pixel = Annotated[float | None, _key("Side of a pixel.")]
Spacing = Annotated[float | None, _key("Distance of neighbouring positions.")]
Positions = Annotated[
    str | None,
    _key("Spinning positions: regular or random.", metavar="WORD",
         autocompletion=proposing(*POSITIONS)),
]  # fmt: skip
Phases = Annotated[
    str | None,
    _key("Of nozzles that move: independent or 'in phase'.", metavar="WORD",
         autocompletion=proposing(*PHASES)),
]  # fmt: skip
Step = Annotated[float | None, _key("Step of the fibres.")]
Seed = Annotated[int | None, _key("Seed of the random numbers.", min=0)]
Periodic = Annotated[
    bool, typer.Option("--periodic", help="Continue the web periodically across.")
]
Titer = Annotated[
    float | None, _key("Mass of the fibre in g/m; 1 dtex is 1e-4.", metavar="G")
]
Zone = Annotated[
    list[float] | None,
    _key("Side of squares whose variation is printed; may be given several times."),
]
Export = Annotated[
    list[str] | None,
    _key(f"Write a {', '.join(EXPORTS)} too; may be given several times.",
         metavar="KIND", autocompletion=proposing(*EXPORTS)),
]  # fmt: skip


@with_parameters
def web(
    context: typer.Context,
    config: Config = None,
    out: Out = Path("results"),
    width: Width = None,
    length: Length = None,
    pixel: Pixel = None,
    spacing: Spacing = None,
    positions: Positions = None,
    phases: Phases = None,
    titer: Titer = None,
    ds: Step = None,
    seed: Seed = None,
    periodic: Periodic = False,
    zone: Zone = None,
    export: Export = None,
    from_: From = None,
    potential: Kind = "quadratic",
    noise: Noise = 1.0,
    belt_speed: BeltSpeed = 0.1,
    relaxation_length: RelaxationLength = None,
    parameters: Parameters = PARAMETERS,
    no_figures: NoFigures = False,
    threads: Threads = None,
) -> None:
    """Lay the web of many fibres, and measure how even it is.

    Writes the web, the configuration used, figures, and what --export asks for; prints
    base weight, variation of square zones, and MD/CD ratio with standard errors.
    Lengths are metres for a process in SI units and an identification, else throwing
    ranges.
    """
    with command(out) as frame:
        given = {
            "width": width, "length": length, "pixel": pixel, "spacing": spacing,
            "positions": positions, "phases": phases, "titer": titer, "ds": ds,
            "seed": seed, "periodic": periodic or None,
            "zones": tuple(zone) if zone else None,
            "exports": tuple(dict.fromkeys(export)) if export else None,
        }  # fmt: skip
        physics = {
            "potential": parameters.make(potential).to_dict(),
            "model": {"noise": noise, "relaxation_length": relaxation_length},
            "curve": {"kind": "moving_belt", "speed": belt_speed},
        }
        options = options_of_model(context)
        if from_ is None:
            tables = tables_of(config, physics, options)
        else:
            found = read_identification(from_, config, options)
            tables = tables_of_identification(found)
        chosen = _chosen(tables, given, no_figures)
        seed_from = "from the configuration" if seed is None else "from `--seed`"
        if chosen.web.seed is None:
            seed_from = "drawn"
        set_threads(threads)
        _lay(frame, chosen, seed_from)


def options_of_model(context: typer.Context) -> list[str]:
    """The options of the model that were written on the command line."""
    sources = {name: context.get_parameter_source(name) for name in _MODEL}
    return [
        f"`--{name.replace('_', '-')}`"
        for name, source in sources.items()
        if source is not None and source.name != "DEFAULT"
    ]


def tables_of(
    config: Path | None, physics: dict[str, Any], options: list[str]
) -> dict[str, Any]:
    """What a file says, or options of the model, or the packaged example."""
    from fpsolve.cli.config.reading import WEB_EXAMPLE, example_path, load_config
    from fpsolve.cli.config.web import WebConfig

    if config is not None and options:
        raise ValueError(
            f"{', '.join(options)} must not be given beside a file, got `{config}`; "
            "change its sections instead."
        )
    if options:
        return {**physics, "web": dict(_WINDOW)}
    path = example_path(WEB_EXAMPLE) if config is None else config
    return load_config(path, WebConfig).model_dump(exclude_none=True)


def _chosen(
    tables: dict[str, Any], given: dict[str, Any], no_figures: bool
) -> WebConfig:
    """The configuration, checked, in which options take the place of keys."""
    from fpsolve.cli.config.reading import check_config
    from fpsolve.cli.config.web import WebConfig

    keys = {name: value for name, value in given.items() if value is not None}
    tables = {**tables, "web": {**tables["web"], **keys}}
    chosen = check_config(tables, "options", WebConfig)
    return chosen.changed("output", figures=False if no_figures else None)


def _lay(frame: Frame, config: WebConfig, seed_from: str) -> None:
    from fpsolve.cli.plan import print_web_plan
    from fpsolve.cli.web_numbers import print_web
    from fpsolve.cli.writing import claim_result, write_result
    from fpsolve.web.lay_web import lay_web

    exports = _exports(config)
    problem = config.build()
    config = config.resolved(problem)
    name = config.output.file_name
    frame.figures = config.output.figures
    claim_result(frame, name)
    frame.claim(*(f"{config.output.name}.{kind}" for kind in exports))
    print_web_plan(config, problem, frame.out, seed_from)
    with frame.computing() as report:
        laid = lay_web(problem.model, **problem.arguments, progress=report)
    show = partial(print_web, zones=config.web.zones)
    write_result(laid, frame, name, show, toml=config.to_toml())
    for kind, write in exports.items():
        typer.echo(write(laid, frame.path(f"{config.output.name}.{kind}")))


def _exports(config: WebConfig) -> dict[str, Any]:
    """What writes the further files, checked before anything is computed."""
    from fpsolve.plotting.web_png import check_picture, save_web_png
    from fpsolve.web.images import tifffile_module
    from fpsolve.web.web import Web

    known = {"png": save_web_png, "tiff": Web.to_tiff, "vtp": Web.to_vtp,
             "csv": Web.to_csv}  # fmt: skip
    wanted = config.web.exports
    if "png" in wanted:
        check_picture(*config.web.window.shape)
    if "tiff" in wanted:
        tifffile_module()
    return {kind: known[kind] for kind in wanted}
