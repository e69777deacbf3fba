"""What a run, a sampling or a web is going to do, before it does it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve.cli.console import print_pairs

if TYPE_CHECKING:
    from fpsolve.cli.config.paths import PathsConfig, PathsProblem
    from fpsolve.cli.config.run import Problem, RunConfig
    from fpsolve.cli.config.web import WebConfig, WebProblem

__all__ = ["print_paths_plan", "print_plan", "print_web_plan", "suggestions"]


def print_plan(config: RunConfig, problem: Problem, out: Path) -> None:
    """Print equation, units, grid, start, scheme, steps, and where they come from."""
    grid = problem.grid
    size = f"{grid.nbytes / 2**20:.3g} MiB per density"
    between = [
        ("grid", f"{_cells(grid)}, {size} ({_source(grid)})"),
        ("start", _with_options(config.initial)),
        ("scheme", f"{_with_options(config.scheme)}, order {problem.scheme.order}"),
        ("run", _steps(problem.arguments)),
    ]
    _print(config, problem.model.equation, between, out)


def print_paths_plan(
    config: PathsConfig, problem: PathsProblem, out: Path, seed_from: str
) -> None:
    """Print equation, units, start, steps, method, and where the seed comes from."""
    arguments = problem.arguments
    start = "ξ = 0, α uniform" if config.start is None else _with_options(config.start)
    between = [
        ("start", start),
        ("paths", _sampling(arguments)),
        ("method", arguments["method"]),
        ("seed", f"{arguments['seed']} ({seed_from})"),
    ]
    if config.histogram is not None:
        between.append(("histogram", _cells(arguments["histogram"])))
    _print(config, problem.model.process_equation, between, out)


def print_web_plan(
    config: WebConfig, problem: WebProblem, out: Path, seed_from: str
) -> None:
    """Print equation, window, positions, steps, and where the seed comes from."""
    plan, unit = problem.order.plan, problem.order.unit
    asked, metres = config.web, "" if config.process is None else " m"
    rows, columns = plan.window.shape
    schedule = plan.ensemble.schedule
    between = [
        ("window", f"{asked.width:g} x {asked.length:g}{metres}, across x along the "
         f"belt; {rows} x {columns} pixels"),
        ("positions", f"{plan.n_fibres}, {unit * plan.spacing:g}{metres} apart, "
         f"{_word(asked.positions)}"),
        ("phases", _word(asked.phases)),
        ("steps", f"ds = {unit * schedule.ds:.3g}{metres}, "
         f"{plan.n_fibres * schedule.n_steps:.3g} in all"),
        ("seed", f"{problem.arguments['seed']} ({seed_from})"),
    ]  # fmt: skip
    _print(config, plan.ensemble.model.process_equation, between, out)


def _word(value: Any) -> str:
    """Return a word, or that there are numbers in its place."""
    return value if isinstance(value, str) else "given"


def _print(
    config: RunConfig | PathsConfig | WebConfig,
    equation: str,
    between: list[tuple[str, str]],
    out: Path,
) -> None:
    """Print equation and units, what is between, and where the result goes."""
    lines = [("equation", equation)]
    if config.process is not None:
        process = config.process.make()
        units = (
            f"ξ and s in units of {1e3 * process.length:g} mm, laid down in "
            f"{1e3 * process.time:g} ms; A = {process.noise:g} m^-1/2"
        )
        lines.append(("units", units))
    print_pairs([*lines, *between, ("result", str(out / config.output.file_name))])


def suggestions(problem: Problem) -> dict[str, str]:
    """Return why grid and step were suggested, for those that were."""
    chosen = {"grid": problem.grid, "ds": problem.arguments["ds"]}
    reasons = {name: getattr(value, "reason", None) for name, value in chosen.items()}
    return {name: reason for name, reason in reasons.items() if reason is not None}


def _cells(grid: Any) -> str:
    """Say how many cells there are, and in which box."""
    from fpsolve.grids.smooth import SmoothPhaseSpaceGrid

    width1, width2 = grid.half_widths
    shape = " x ".join(map(str, grid.shape))
    box = f"|ξ₁| < {width1:g}, |ξ₂| < {width2:g}"
    if isinstance(grid, SmoothPhaseSpaceGrid):
        box += f", |κ| < {grid.kappa_half_width:g}"
    return f"{shape} cells, {box}"


def _steps(arguments: dict[str, Any]) -> str:
    start, end = arguments["s_span"]
    ds = arguments["ds"]
    also = _levels(arguments["extrapolate"], arguments.get("tolerance"))
    return f"s from {start:g} to {end:g}, ds = {ds:g}{also} ({_source(ds)})"


def _levels(extrapolate: bool | int, tolerance: float | None) -> str:
    """Say which shorter steps there are."""
    if tolerance is not None:
        return f", ds/2, … until the step leaves {tolerance:g}, extrapolated"
    if not extrapolate:
        return ""
    if extrapolate is True or extrapolate == 2:
        return " and ds/2, extrapolated"
    return f", ds/2, …, ds/{extrapolate}, extrapolated"


def _sampling(arguments: dict[str, Any]) -> str:
    end, ds = arguments["s_end"], arguments["ds"]
    kept = "" if arguments["keep"] else ", positions not kept"
    return (
        f"{arguments['n_paths']} of length {end:g}, ds = {ds:g}, saved at "
        f"{len(arguments['save_at'])} arclengths{kept}"
    )


def _source(value: Any) -> str:
    """Return why a value was suggested, or that the configuration gives it."""
    reason = getattr(value, "reason", None)
    return "from the configuration" if reason is None else f"suggested: {reason}"


def _with_options(section: Any) -> str:
    """Write a section as a call."""
    options = section.model_dump(exclude_none=True)
    kind = options.pop("kind")
    return f"{kind}({', '.join(f'{name}={value}' for name, value in options.items())})"
