"""What a run is going to do, before it does it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from fpsolve.cli.console import print_pairs

if TYPE_CHECKING:
    from fpsolve.cli.config.run import Problem, RunConfig

__all__ = ["print_plan", "suggestions", "units_text", "with_options"]


def print_plan(config: RunConfig, problem: Problem, out: Path) -> None:
    """Print equation, units, grid, start, scheme, steps, and where they come from."""
    print_pairs(_lines(config, problem, out))


def _lines(config: RunConfig, problem: Problem, out: Path) -> list[tuple[str, str]]:
    lines = [("equation", problem.model.equation)]
    if config.process is not None:
        lines.append(("units", units_text(config.process.make())))
    lines += [
        ("grid", _grid(problem)),
        ("start", with_options(config.initial)),
        ("scheme", f"{with_options(config.scheme)}, order {problem.scheme.order}"),
        ("run", _steps(problem.arguments)),
        ("result", str(out / config.output.file_name)),
    ]
    return lines


def suggestions(problem: Problem) -> dict[str, str]:
    """Return why grid and step were suggested, for those that were."""
    chosen = {"grid": problem.grid, "ds": problem.arguments["ds"]}
    reasons = {name: getattr(value, "reason", None) for name, value in chosen.items()}
    return {name: reason for name, reason in reasons.items() if reason is not None}


def units_text(process: Any) -> str:
    """Say what one unit of length means in SI units."""
    return (
        f"ξ and s in units of {1e3 * process.length:g} mm, laid down in "
        f"{1e3 * process.time:g} ms; A = {process.noise:g} m^-1/2"
    )


def _grid(problem: Problem) -> str:
    grid = problem.grid
    cells = " x ".join(map(str, grid.shape))
    width1, width2 = grid.half_widths
    box = f"|ξ₁| < {width1:g}, |ξ₂| < {width2:g}"
    size = f"{grid.nbytes / 2**20:.3g} MiB per density"
    return f"{cells} cells, {box}, {size} ({_source(grid)})"


def _steps(arguments: dict[str, Any]) -> str:
    start, end = arguments["s_span"]
    ds = arguments["ds"]
    also = " and ds/2, extrapolated" if arguments["extrapolate"] else ""
    return f"s from {start:g} to {end:g}, ds = {ds:g}{also} ({_source(ds)})"


def _source(value: Any) -> str:
    """Return why a value was suggested, or that the configuration gives it."""
    reason = getattr(value, "reason", None)
    return "from the configuration" if reason is None else f"suggested: {reason}"


def with_options(section: Any) -> str:
    """Write a section as a call."""
    options = section.model_dump(exclude_none=True)
    kind = options.pop("kind")
    return f"{kind}({', '.join(f'{name}={value}' for name, value in options.items())})"
