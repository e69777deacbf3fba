"""The fibre that a table and options of `fpsolve identify` describe, in metres."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from fpsolve.cli.options import MOTIONS, UNITS

if TYPE_CHECKING:
    from fpsolve.model.curves.curve import Curve
    from fpsolve.paths.fibres.fibre_curve import FibreCurve

__all__ = ["Measured", "measured_fibre"]

# Files of results, which have units and a reference curve.
SAVED = (".nc", ".zarr")
# Part of the distance from the reference curve below which the rest must be for the
# fibre to drift away from it: what is known of it then is that the curve is wrong.
_REST = 0.3
# Spread about the reference curve in metres, beyond which no process throws fibres.
_SPREADS = (1e-4, 0.5)


class Measured(NamedTuple):
    """What was said of a fibre; lengths in metres, those of the table in its unit."""

    table: Path | None
    belt_speed: float | None
    ds: float | None
    unit: str
    position_error: float | None
    nozzle: str | None
    angular_speed: float | None
    radius: float | None
    phase: float | None
    pixel: float | None = None


def measured_fibre(given: Measured) -> FibreCurve:
    """Return the fibre with its reference curve.

    Raises
    ------
    ValueError
        If options do not fit each other or the table, or the fibre lies so far from
        its curve, or so near, that the unit cannot be right.
    FileNotFoundError, FileFormatError
        If there is no table, or it is none.
    """
    from fpsolve.paths.fibres.fibre_curve import FibreCurve

    if given.table is not None and given.table.suffix in SAVED:
        return _saved(given.table, given)
    given = _completed(given)
    curve = _curve(given)
    error = given.position_error
    known = {} if error is None else {"position_error": error}
    fibre = FibreCurve.read_csv(
        _table(given.table), given.ds, unit=1 / _unit(given), curve=curve, **known
    )
    if curve is None:
        fibre = _fitted(fibre, given)
    _check_drift(fibre, given)
    _check_spread(fibre, given)
    return fibre


def _saved(path: Path, given: Measured) -> FibreCurve:
    """A curve that was saved with its reference curve, as `fpsolve string` does."""
    from fpsolve.paths.fibres.fibre_curve import FibreCurve
    from fpsolve.results.load import load

    found = load(path)
    if not isinstance(found, FibreCurve):
        raise ValueError(
            f"`CURVE` must be a table or a saved fibre curve, got `{path}`, which "
            f"holds a {type(found).__name__}."
        )
    if found.curve is None:
        raise ValueError(
            f"`CURVE` must be saved with its reference curve, got `{path}` without; "
            "write its points to a table and give `--belt-speed`."
        )
    names = ("belt_speed", "ds", "position_error", "nozzle", "angular_speed", "radius",
             "phase", "pixel")  # fmt: skip
    told = [name for name in names if getattr(given, name) is not None]
    if told:
        raise ValueError(
            f"`--{told[0].replace('_', '-')}` must not be given beside a saved curve, "
            f"got {getattr(given, told[0])}; `{path}` says it."
        )
    return found


def _completed(given: Measured) -> Measured:
    """With what is known of the packaged fibre, if it is meant."""
    if given.table is not None:
        if given.belt_speed is None:
            raise ValueError(
                "`--belt-speed` must be given with a fibre, got none; it is belt speed "
                "/ spinning speed, 0 for a belt at rest."
            )
        return given
    from fpsolve.studies.identification import example

    known: dict[str, Any] = {
        "table": Path(str(files("fpsolve") / "examples" / "fibre.csv")),
        "belt_speed": example.BELT_SPEED, "ds": example.SPACING,
        "position_error": example.POSITION_ERROR,
    }  # fmt: skip
    return given._replace(
        **{name: value for name, value in known.items() if getattr(given, name) is None}
    )


def _unit(given: Measured) -> float:
    """Metres that a length of one in the table is."""
    from fpsolve._support.checks import check_one_of, check_positive

    check_one_of("--unit", given.unit, UNITS)
    if given.pixel is None:
        return UNITS[given.unit]
    if given.unit != "m":
        raise ValueError(
            f"`--unit` must not be given beside `--pixel`, got {given.unit}; the table "
            "is in pixels."
        )
    return check_positive("--pixel", given.pixel)


def _table(path: Path | None) -> Path:
    if path is None or not path.is_file():
        raise FileNotFoundError(
            f"`CURVE.csv` must be an existing table, got `{path}`; leave it out to "
            "identify the packaged fibre."
        )
    return path


def _curve(given: Measured) -> Curve | None:
    """The reference curve; None if radius and phase must be fitted."""
    from fpsolve._support.checks import check_one_of
    from fpsolve.model.curves.belts import FixedBelt, MovingBelt
    from fpsolve.model.curves.nozzles import OscillatingNozzle, RotatingNozzle

    speed: Any = given.belt_speed
    if given.nozzle is None:
        _check_none(given, "angular_speed", "radius", "phase", without="--nozzle")
        return MovingBelt(speed) if speed else FixedBelt()
    check_one_of("--nozzle", given.nozzle, MOTIONS)
    if given.angular_speed is None:
        raise ValueError(
            "`--angular-speed` must be given with `--nozzle`, got none; it is radians "
            "per metre of fibre."
        )
    if given.radius is None:
        _check_none(given, "phase", without="--radius")
        return None
    kinds = {"rotating": RotatingNozzle, "oscillating": OscillatingNozzle}
    return kinds[given.nozzle](
        speed, given.radius, given.angular_speed, given.phase or 0.0
    )


def _check_none(given: Measured, *names: str, without: str) -> None:
    for name in names:
        if getattr(given, name) is not None:
            raise ValueError(
                f"`--{name.replace('_', '-')}` must not be given without `{without}`, "
                f"got {getattr(given, name):g}; give both."
            )


def _fitted(fibre: FibreCurve, given: Measured) -> FibreCurve:
    from fpsolve.paths.fibres.fit_curve import fit_curve

    speed, turning, motion = given.belt_speed, given.angular_speed, given.nozzle
    assert speed is not None
    assert turning is not None
    assert motion is not None
    return fit_curve(fibre, turning, speed, motion=motion).fibre


def _check_drift(fibre: FibreCurve, given: Measured) -> None:
    """Raise ValueError if ξ of the longest fibre is little but a straight line."""
    import numpy as np

    xi = max(fibre.deviations, key=len)
    xi = xi - xi.mean(axis=0)
    s = fibre.ds * (np.arange(len(xi)) - 0.5 * (len(xi) - 1))
    drift = s @ xi / (s @ s)
    rest = np.linalg.norm(xi - np.outer(s, drift))
    if not rest < _REST * np.linalg.norm(xi):
        return
    # Of the points themselves: γ moves by -v along the belt.
    along, across = drift[0] - (given.belt_speed or 0.0), drift[1]
    raise ValueError(
        f"`--belt-speed` must be that of the fibre, got {given.belt_speed:g}, with "
        f"which it drifts away from its curve: its points move by {along:.3g} m along "
        f"and {across:.3g} m across in a metre of fibre. They must move by minus the "
        "belt speed along and by nothing across: give another, turn the axis round, or "
        "exchange the columns."
    )


def _check_spread(fibre: FibreCurve, given: Measured) -> None:
    """Raise ValueError unless ξ is as wide as fibres are thrown."""
    import numpy as np

    xi = np.concatenate(fibre.deviations)
    spread = float(np.sqrt(np.mean(np.square(xi))))
    low, high = _SPREADS
    if not low <= spread <= high:
        raise ValueError(
            f"`--unit` and `--belt-speed` must be those of the fibre, got {given.unit} "
            f"and {given.belt_speed:g}, with which it lies {spread:.3g} m from its "
            f"reference curve in root mean square, not {low:g} to {high:g} m; the belt "
            "carries a fibre towards lower x."
        )
