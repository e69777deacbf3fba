"""Exceptions a caller may want to catch; each carries its numbers as attributes.

A wrong argument is an ordinary `ValueError` or `TypeError`. The classes here are for
what shows only while a computation runs, and for files and configurations that come
from elsewhere. All of them survive pickling, so that they cross process boundaries.
"""

from __future__ import annotations

import copyreg
import inspect
import math
import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields
from typing import Any, TypeVar, dataclass_transform

__all__ = [
    "CheckpointError",
    "CheckpointMismatchError",
    "CirculationError",
    "ConfigurationError",
    "CurvatureRangeError",
    "DomainTooSmallError",
    "EdgeLengthError",
    "EntropyRiseError",
    "EquilibriumError",
    "FileFormatError",
    "FlowRangeError",
    "ForkedProcessError",
    "FpsolveError",
    "FrictionError",
    "GridMismatchError",
    "MassCorrectionError",
    "MassDriftError",
    "MemoryLimitError",
    "NegativeDensityError",
    "NoiseStrengthError",
    "NonFiniteDensityError",
    "NonFinitePathError",
    "NotRepeatableError",
    "ObservationError",
    "RunError",
    "RunInterrupted",
    "SteadyStateError",
    "ToleranceError",
    "UnreachableTargetError",
]


Given = TypeVar("Given", bound="type[FpsolveError]")


def said(words: str, kind: str = "", **options: Any) -> Any:
    """Argument, attribute and entry in the docstring of an exception, all at once."""
    return field(**options, metadata={"words": words, "kind": kind})


@dataclass_transform(eq_default=False, field_specifiers=(said,))
def stated(error: Given) -> Given:
    """Make constructor and docstring from what is `said`, the message from `_says`."""
    made: Any = dataclass(eq=False, repr=False)(error)
    lines = [inspect.cleandoc(error.__doc__ or "")]
    if fields(made):
        lines += ["", "Parameters", "----------"]
    for one in fields(made):
        kind = one.metadata["kind"] or one.type
        lines += [f"{one.name} : {kind}", f"    {one.metadata['words']}"]
        if one.default is not MISSING:
            # The constructor has it.
            delattr(error, one.name)
    error.__doc__ = "\n".join(lines)
    return error


class FpsolveError(Exception):
    """Base of every exception of fpsolve; catch it to catch them all."""

    _says = ""

    def __post_init__(self) -> None:
        texts = {
            name: os.fspath(value) if isinstance(value, os.PathLike) else value
            for name, value in vars(self).items()
        }
        self.args = (self._says.format_map(texts | self._texts()),)

    def _texts(self) -> dict[str, str]:
        """What the message has beside the arguments."""
        return {}

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]:
        # The default calls the constructor with the finished message as its only
        # argument, which fails for every constructor that takes numbers.
        return copyreg.__newobj__, (type(self), *self.args), self.__dict__  # type: ignore[attr-defined]


class RunError(FpsolveError):
    """A run stopped because going on would give a wrong result.

    Attributes
    ----------
    solution : Solution or None
        What the run had recorded until then; None when no run was involved.
    """

    solution: Any = None


@stated
class MassDriftError(RunError):
    """The mass ∫ p dξ dα moved away from its initial value."""

    s: float = said("Arclength at which the drift was noticed.")
    drift: float = said("Relative deviation (mass - initial mass) / initial mass.")
    tolerance: float = said("Largest drift allowed.")
    _says = (
        "relative mass drift {drift:.2g} exceeds tolerance {tolerance:g} at s = {s:g}; "
        "use a conservative scheme, a smaller `ds`, or a larger `mass_tolerance` if "
        "this drift is acceptable."
    )


@stated
class NegativeDensityError(RunError):
    """A substantial part of the density has become negative.

    Undershoot beside a steep front is harmless; this much is a density that is not
    resolved, or a scheme that is unstable.
    """

    s: float = said("Arclength at which it was noticed.")
    negative_mass: float = said("∫ max(-p, 0) relative to the mass.")
    tolerance: float = said("Largest share allowed.")
    _says = (
        "negative mass {negative_mass:.2g} exceeds tolerance {tolerance:g} at s = "
        "{s:g}; refine the grid, use `positive=True` or the form `h`, or raise "
        "`negative_tolerance` if this undershoot is acceptable."
    )


@stated
class NonFiniteDensityError(RunError):
    """The density holds a NaN or an infinity."""

    s: float = said("Arclength at which it was noticed.")
    index: tuple[int, ...] = said(
        "Index (i, j, k) of the first such cell in array order.", "tuple of int"
    )
    _says = (
        "the density is not finite at s = {s:g}, first at index {index}; reduce `ds` "
        "or choose a scheme that is stable for this noise."
    )

    def __post_init__(self) -> None:
        self.index = tuple(int(i) for i in self.index)
        super().__post_init__()


@stated
class NonFinitePathError(RunError):
    """A path came to a point where the force, or its own position, is not finite."""

    path: int = said("Number of the path; all paths of its ensemble stop with it.")
    s: float = said("Arclength at the beginning of the step.")
    xi: Sequence[float] = said("Where the path was.", "(float, float)")
    gradient: Sequence[float] = said("∇B there.", "(float, float)")
    _says = (
        "path {path} cannot go on at s = {s:g}: the gradient of the potential at xi = "
        "({xi[0]:g}, {xi[1]:g}) is ({gradient[0]:g}, {gradient[1]:g}); define it "
        "wherever a path may come, or start the paths closer to the origin."
    )

    def __post_init__(self) -> None:
        self.xi = tuple(float(x) for x in self.xi)
        self.gradient = tuple(float(slope) for slope in self.gradient)
        super().__post_init__()


@stated
class DomainTooSmallError(RunError):
    """Too much mass sits at the boundary of the ξ box.

    The box is periodic in ξ, so mass that reaches its boundary comes back on the
    other side and the result is wrong.
    """

    boundary_mass: float = said("Mass found next to the boundary of the box.")
    half_width: float | tuple[float, float] = said(
        "Half widths of the box.", "float or tuple of float"
    )
    s: float | None = said(
        "Arclength at which it was noticed.", "float, optional", default=None
    )
    tolerance: float | None = said(
        "Largest boundary mass allowed.", "float, optional", default=None
    )
    _says = (
        "boundary mass {boundary_mass:.2g}{limit}{place}: the box of half width {box} "
        "is too small; enlarge `half_width`."
    )

    def _texts(self) -> dict[str, str]:
        s, tolerance, box = self.s, self.tolerance, self.half_width
        sides = [f"{side:g}" for side in (box if isinstance(box, tuple) else (box,))]
        return {
            "limit": "" if tolerance is None else f" exceeds tolerance {tolerance:g}",
            "place": "" if s is None else f" at s = {s:g}",
            "box": f"({', '.join(sides)})" if len(sides) > 1 else sides[0],
        }


@stated
class CurvatureRangeError(RunError):
    """Too much mass sits at the ends of the range of κ.

    Densities are periodic in κ for the scheme, so what reaches an end comes back at the
    other and the result is wrong.
    """

    boundary_mass: float = said(
        "Share of the mass in the first and the last cells of κ."
    )
    kappa_half_width: float = said("Largest curvature of the grid.")
    tolerance: float = said("Largest share allowed.")
    s: float | None = said(
        "Arclength at which it was noticed.", "float, optional", default=None
    )
    _says = (
        "boundary mass {boundary_mass:.2g} in κ exceeds tolerance {tolerance:g}"
        "{place}: curvatures up to {kappa_half_width:g} are too few; enlarge "
        "`kappa_half_width`."
    )

    def _texts(self) -> dict[str, str]:
        return {"place": "" if self.s is None else f" at s = {self.s:g}"}


@stated
class EntropyRiseError(RunError):
    """The relative entropy rose on a belt at rest, where it can only fall."""

    s: float = said("Arclength at which it was noticed.")
    rise: float = said("H(s) minus the smallest H before.")
    tolerance: float = said("Largest rise allowed.")
    _says = (
        "relative entropy risen by {rise:.2g}, more than the tolerance {tolerance:g}, "
        "at s = {s:g}, where it can only fall: the density is wrong; use more cells or "
        "a smaller `half_width` where B is steep, a smaller `ds`, or a larger "
        "`entropy_tolerance` if this is acceptable."
    )


@stated
class CirculationError(RunError):
    """The circulation E G left its exact law e^{−A²s/2}: isotropic B, belt at rest."""

    s: float = said("Arclength at which it was noticed.")
    deviation: float = said(
        "E G minus what the law gives, relative to the largest |G|: the L1 error of "
        "the density is at least as large."
    )
    tolerance: float = said("Largest deviation allowed.")
    _says = (
        "circulation off its exact law by {deviation:.2g}, more than the tolerance "
        "{tolerance:g}, at s = {s:g}: the L1 error of the density is at least as "
        "large; use a smaller `ds`, a finer grid, or a larger `circulation_tolerance` "
        "if this is acceptable."
    )


@stated
class MassCorrectionError(RunError):
    """The weight θ of the adjusted advection [DHP99]_ left [0, 1].

    Outside that interval the correction extrapolates, and rescaling would hide a
    blow-up.
    """

    s: float = said("Arclength at the beginning of the step.")
    theta: float = said("The weight found.")
    step: int = said("Number of the step, from 0.")
    _says = (
        "adjusted-advection weight theta = {theta:g} outside [0, 1] at s = {s:g} "
        "(step {step}); refine the grid, raise `interpolation_order`, or enlarge `ds`: "
        "moving feet by η b ds² can restore no more mass than that. At low noise the "
        "form `p` is unstable; use the form `h`."
    )


@stated
class GridMismatchError(FpsolveError, ValueError):
    """An array does not have the shape of the grid."""

    expected: tuple[int, ...] = said("Shape of the grid.", "tuple of int")
    got: tuple[int, ...] = said("Shape of the array.", "tuple of int")
    name: str = said("Name of the argument.", "str, optional", default="p")
    _says = "`{name}` must have the shape {expected} of the grid, got {got}."


@stated
class MemoryLimitError(FpsolveError):
    """A run would need more memory than it may use."""

    required: int = said("Memory in bytes.")
    available: int = said("Memory in bytes.")
    remedy: str = said(
        "What takes less.", default="save fewer densities, choose a coarser grid"
    )
    _says = (
        "the run needs {needed} but {there} are available; {remedy}, or raise "
        "`memory_limit`."
    )

    def _texts(self) -> dict[str, str]:
        needed, there = _bytes_text(self.required), _bytes_text(self.available)
        return {"needed": needed, "there": there}


@stated
class ObservationError(RunError):
    """A function of the caller's own, given as `observe`, gave no finite number."""

    name: str = said("That of the series.")
    s: float = said("Arclength of the density that it was asked for.")
    reason: str = said("What it gave or raised.")
    _says = (
        "`observe[{name!r}]` must give a finite number for every density, failed at "
        "s = {s:g}: {why}; try it on p0 and the grid."
    )

    def _texts(self) -> dict[str, str]:
        return {"why": self.reason.rstrip(".")}


class NotRepeatableError(FpsolveError, ValueError):
    """A result does not say how it was made, or was made with a user's own code."""


@stated
class CheckpointError(RunError):
    """A checkpoint could not be written, or what it holds cannot be read back.

    What is written last is kept.
    """

    path: str | os.PathLike[str] = said("File or folder.", "str or os.PathLike")
    reason: str = said(
        "What the operating system says, or what is damaged, without a final full stop."
    )
    remedy: str = said("What is kept, and how to go on.")
    action: str = said("What could not be done.", default="written", kw_only=True)
    _says = "checkpoint `{path}` cannot be {action}: {reason}; {remedy}."


@stated
class CheckpointMismatchError(FpsolveError, ValueError):
    """A folder holds the checkpoint of another run."""

    directory: str | os.PathLike[str] = said("The folder.", "str or os.PathLike")
    differences: Sequence[str] = said(
        "One for every argument that differs, with both values.", "sequence of str"
    )
    _says = (
        "checkpoint `{directory}` is of another run: {all}; use the arguments of that "
        "run, or name another folder, or remove this one to begin anew."
    )

    def __post_init__(self) -> None:
        self.differences = tuple(self.differences)
        super().__post_init__()

    def _texts(self) -> dict[str, str]:
        return {"all": ", ".join(self.differences)}


@stated
class FlowRangeError(FpsolveError):
    """A fibre has left the region in which the flow of the air is known."""

    t: float = said("Time at which it is there.")
    position: tuple[float, ...] = said("A place outside, in m.")
    _says = (
        "the fibre is at {place} m at t = {t:g} s, outside of the table of the flow; "
        "enlarge the table or shorten the fibre."
    )

    def _texts(self) -> dict[str, str]:
        return {"place": "(" + ", ".join(f"{x:.4g}" for x in self.position) + ")"}


@stated
class SteadyStateError(FpsolveError):
    """The search for a stationary density did not converge."""

    residual: float = said("Residual reached.")
    tolerance: float = said("Residual asked for.")
    _says = (
        "steady state not reached: residual {residual:.2g} exceeds tolerance "
        "{tolerance:g}; refine the grid, shorten `ds` or enlarge `tolerance`."
    )


@stated
class EdgeLengthError(RunError):
    """A step of a fibre that keeps its length was not found."""

    t: float = said("Time at which the step begins.")
    dt: float = said("Length of the step.")
    stretched: float = said("Relative deviation of an edge that is left.")
    _says = (
        "no step of {dt:g} s was found from t = {t:g} s on in which the fibre keeps "
        "its length, an edge is off by a part of {stretched:.2g}; take more `n_steps`."
    )


@stated
class FrictionError(EdgeLengthError):
    """A step of a fibre that rubs on its belt was not found."""

    left: int = said(
        "Nodes that change between sticking and sliding, or move what was left behind."
    )
    _says = (
        "no step of {dt:g} s was found from t = {t:g} s on in which friction on the "
        "belt is settled: {left} nodes change between sticking, sliding and the air, "
        "or move what was left behind, and an edge is off by a part of {stretched:.2g};"
        " take more `n_steps`, or more `friction`."
    )


@stated
class NoiseStrengthError(RunError):
    """Noise turns the edges of a fibre by more in one step than a direction bears."""

    t: float = said("Time at which the step begins.")
    dt: float = said("Length of the step.")
    amplitude: float = said("Of the noise, in N s^½/m^½.")
    turn: float = said("Root mean square of the angle, in rad.")
    n_steps: int = said("Number of steps in which it is at most ½.")
    _says = (
        "`turbulence` of {amplitude:.3g} N s^½/m^½ turns edges by {turn:.3g} rad in a "
        "step of {dt:.3g} s from t = {t:.3g} s on, after which their directions mean "
        "nothing; take at least {n_steps} `n_steps`, in which they turn by ½."
    )


@stated
class EquilibriumError(FpsolveError):
    """A fibre did not come to rest."""

    residual: float = said("Largest force left on a node, relative to the whole.")
    tolerance: float = said("Residual asked for.")
    _says = (
        "no position of rest was found: a force of {residual:.2g} of the weight and "
        "the stiffness is left, {tolerance:g} are allowed; give a `shape` that is "
        "nearer to it."
    )


class _Best:
    """What a search that fell short leaves; no argument of an error."""

    solution: Any = None


@stated
class ToleranceError(_Best, FpsolveError):
    """A result could not be computed as accurately as asked for.

    A run of `solve` leaves the best that it found as `.solution`, others None.
    """

    reached: float = said("Error estimated for the best result that was possible.")
    tolerance: float = said("Error asked for.")
    remedy: str = said(
        "What helps.", default="raise `memory_limit` or enlarge `tolerance`"
    )
    _says = "tolerance {tolerance:g} not reached: {known}; {remedy}."

    def _texts(self) -> dict[str, str]:
        if math.isfinite(self.reached):
            return {"known": f"the error is estimated at {self.reached:.2g}"}
        return {"known": "there is no estimate of the error yet"}


@stated
class UnreachableTargetError(FpsolveError):
    """No process within the bounds was found whose web is as even as asked for."""

    zone: float = said("Side of the zones that are farthest from their target.")
    target: float = said("Largest CV allowed of them.")
    reached: float = said("The smallest CV found.")
    error: float = said("Bound of the error of this one.")
    place: Mapping[str, float] = said(
        "Free parameters where it was found.", "mapping of str to float"
    )
    _says = (
        "`target` CV <= {target:g} of zones of {zone:g} m cannot be met within "
        "`bounds`: the best that was found is {reached:.4g} ± {error:.1g}, at "
        "{where}; allow more, widen the bounds or free another parameter."
    )

    def _texts(self) -> dict[str, str]:
        pairs = self.place.items()
        return {"where": ", ".join(f"{name} = {value:.4g}" for name, value in pairs)}


@stated
class ForkedProcessError(FpsolveError, RuntimeError):
    """A kernel was called in a process that was forked from running threads.

    GNU OpenMP, from which numba has its threads on Linux, would end the process or
    wait for ever for threads that a fork does not copy.
    """

    _says = (
        "kernels cannot run in a process that was forked after their threads had "
        "started; start it by `multiprocessing.get_context('spawn')` (or "
        "'forkserver'), for an executor `mp_context=` of the same, or set "
        "NUMBA_THREADING_LAYER=workqueue, whose threads start anew."
    )


class ConfigurationError(FpsolveError):
    """A configuration file asks for something that does not exist or does not fit."""


@stated
class FileFormatError(FpsolveError):
    """A file is not what it should be."""

    path: str | os.PathLike[str] = said("The file.", "str or os.PathLike")
    reason: str = said("What is wrong with it, without a final full stop.")
    _says = "cannot read `{path}`: {reason}."


class RunInterrupted(KeyboardInterrupt):
    """The user interrupted a run; `solution` holds what it had recorded until then.

    Parameters
    ----------
    solution : Solution
        The partial result, with status "interrupted".
    """

    def __init__(self, solution: Any) -> None:
        super().__init__("run interrupted; the partial result is in `solution`.")
        self.solution = solution

    def __reduce__(self) -> tuple[type[RunInterrupted], tuple[Any]]:
        return type(self), (self.solution,)


def _bytes_text(n_bytes: int) -> str:
    if n_bytes < 2**30:
        return f"{n_bytes / 2**20:.3g} MiB"
    return f"{n_bytes / 2**30:.3g} GiB"
