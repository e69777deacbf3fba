"""Exceptions a caller may want to catch; each carries its numbers as attributes.

A wrong argument is an ordinary `ValueError` or `TypeError`. The classes here are for
what shows only while a computation runs, and for files and configurations that come
from elsewhere. All of them survive pickling, so that they cross process boundaries.
"""

from __future__ import annotations

import copyreg
import math
import os
from collections.abc import Callable, Sequence
from typing import Any

__all__ = [
    "CheckpointError",
    "CheckpointMismatchError",
    "CirculationError",
    "ConfigurationError",
    "DomainTooSmallError",
    "EntropyRiseError",
    "FileFormatError",
    "ForkedProcessError",
    "FpsolveError",
    "GridMismatchError",
    "MassCorrectionError",
    "MassDriftError",
    "MemoryLimitError",
    "NegativeDensityError",
    "NonFiniteDensityError",
    "NonFinitePathError",
    "NotRepeatableError",
    "ObservationError",
    "RunError",
    "RunInterrupted",
    "SteadyStateError",
    "ToleranceError",
]


class FpsolveError(Exception):
    """Base of every exception of fpsolve; catch it to catch them all."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any]]:
        # The default calls the constructor with the finished message as its only
        # argument, which fails for every constructor that takes numbers.
        return copyreg.__newobj__, (type(self), *self.args), self.__dict__  # type: ignore[attr-defined]


class RunError(FpsolveError):
    """A run stopped because going on would give a wrong density.

    Attributes
    ----------
    solution : Solution or None
        What the run had recorded until then; None when no run was involved.
    """

    solution: Any = None


class MassDriftError(RunError):
    """The mass ∫ p dξ dα moved away from its initial value.

    Parameters
    ----------
    s : float
        Arclength at which the drift was noticed.
    drift : float
        Relative deviation (mass - initial mass) / initial mass.
    tolerance : float
        Largest drift allowed.
    """

    def __init__(self, s: float, drift: float, tolerance: float) -> None:
        super().__init__(
            f"relative mass drift {drift:.2g} exceeds tolerance {tolerance:g} "
            f"at s = {s:g}; use a conservative scheme, a smaller `ds`, or a larger "
            "`mass_tolerance` if this drift is acceptable."
        )
        self.s = s
        self.drift = drift
        self.tolerance = tolerance


class NegativeDensityError(RunError):
    """A substantial part of the density has become negative.

    Undershoot beside a steep front is harmless; this much is a density that is not
    resolved, or a scheme that is unstable.

    Parameters
    ----------
    s : float
        Arclength at which it was noticed.
    negative_mass : float
        ∫ max(-p, 0) relative to the mass.
    tolerance : float
        Largest share allowed.
    """

    def __init__(self, s: float, negative_mass: float, tolerance: float) -> None:
        super().__init__(
            f"negative mass {negative_mass:.2g} exceeds tolerance {tolerance:g} at "
            f"s = {s:g}; refine the grid, use `positive=True` or the form `h`, or "
            "raise `negative_tolerance` if this undershoot is acceptable."
        )
        self.s = s
        self.negative_mass = negative_mass
        self.tolerance = tolerance


class NonFiniteDensityError(RunError):
    """The density holds a NaN or an infinity.

    Parameters
    ----------
    s : float
        Arclength at which it was noticed.
    index : tuple of int
        Index (i, j, k) of the first such cell in array order.
    """

    def __init__(self, s: float, index: tuple[int, ...]) -> None:
        index = tuple(int(i) for i in index)
        super().__init__(
            f"the density is not finite at s = {s:g}, first at index {index}; "
            "reduce `ds` or choose a scheme that is stable for this noise."
        )
        self.s = s
        self.index = index


class NonFinitePathError(RunError):
    """A path came to a point where the force, or its own position, is not finite.

    Parameters
    ----------
    path : int
        Number of the path; all paths of its ensemble stop with it.
    s : float
        Arclength at the beginning of the step.
    xi : (float, float)
        Where the path was.
    gradient : (float, float)
        ∇B there.
    """

    def __init__(
        self, path: int, s: float, xi: Sequence[float], gradient: Sequence[float]
    ) -> None:
        (xi1, xi2), (slope1, slope2) = xi, gradient
        super().__init__(
            f"path {path} cannot go on at s = {s:g}: the gradient of the potential at "
            f"xi = ({xi1:g}, {xi2:g}) is ({slope1:g}, {slope2:g}); define it wherever "
            "a path may come, or start the paths closer to the origin."
        )
        self.path = path
        self.s = s
        self.xi = float(xi1), float(xi2)
        self.gradient = float(slope1), float(slope2)


class DomainTooSmallError(RunError):
    """Too much mass sits at the boundary of the ξ box.

    The box is periodic in ξ, so mass that reaches its boundary comes back on the
    other side and the result is wrong.

    Parameters
    ----------
    boundary_mass : float
        Mass found next to the boundary of the box.
    half_width : float or tuple of float
        Half widths of the box.
    s : float, optional
        Arclength at which it was noticed.
    tolerance : float, optional
        Largest boundary mass allowed.
    """

    def __init__(
        self,
        boundary_mass: float,
        half_width: float | tuple[float, float],
        s: float | None = None,
        tolerance: float | None = None,
    ) -> None:
        limit = "" if tolerance is None else f" exceeds tolerance {tolerance:g}"
        place = "" if s is None else f" at s = {s:g}"
        super().__init__(
            f"boundary mass {boundary_mass:.2g}{limit}{place}: the box of half width "
            f"{_half_width_text(half_width)} is too small; enlarge `half_width`."
        )
        self.boundary_mass = boundary_mass
        self.half_width = half_width
        self.s = s
        self.tolerance = tolerance


class EntropyRiseError(RunError):
    """The relative entropy rose on a belt at rest, where it can only fall.

    Parameters
    ----------
    s : float
        Arclength at which it was noticed.
    rise : float
        H(s) minus the smallest H before.
    tolerance : float
        Largest rise allowed.
    """

    def __init__(self, s: float, rise: float, tolerance: float) -> None:
        super().__init__(
            f"relative entropy risen by {rise:.2g}, more than the tolerance "
            f"{tolerance:g}, at s = {s:g}, where it can only fall: the density is "
            "wrong; use more cells or a smaller `half_width` where B is steep, a "
            "smaller `ds`, or a larger `entropy_tolerance` if this is acceptable."
        )
        self.s = s
        self.rise = rise
        self.tolerance = tolerance


class CirculationError(RunError):
    """The circulation E G left its exact law e^{−A²s/2}: isotropic B, belt at rest.

    Parameters
    ----------
    s : float
        Arclength at which it was noticed.
    deviation : float
        E G minus what the law gives, relative to the largest |G|: the L1 error of the
        density is at least as large.
    tolerance : float
        Largest deviation allowed.
    """

    def __init__(self, s: float, deviation: float, tolerance: float) -> None:
        super().__init__(
            f"circulation off its exact law by {deviation:.2g}, more than the "
            f"tolerance {tolerance:g}, at s = {s:g}: the L1 error of the density is at "
            "least as large; use a smaller `ds`, a finer grid, or a larger "
            "`circulation_tolerance` if this is acceptable."
        )
        self.s = s
        self.deviation = deviation
        self.tolerance = tolerance


class MassCorrectionError(RunError):
    """The weight θ of the adjusted advection left [0, 1].

    Outside that interval the correction extrapolates, and rescaling would hide a
    blow-up.

    Parameters
    ----------
    s : float
        Arclength at the beginning of the step.
    theta : float
        The weight found.
    step : int
        Number of the step, from 0.

    References
    ----------
    [DHP99]_.
    """

    def __init__(self, s: float, theta: float, step: int) -> None:
        super().__init__(
            f"adjusted-advection weight theta = {theta:g} outside [0, 1] at s = {s:g} "
            f"(step {step}); refine the grid, raise `interpolation_order`, or enlarge "
            "`ds`: moving feet by η b ds² can restore no more mass than that. At low "
            "noise the form `p` is unstable; use the form `h`."
        )
        self.s = s
        self.theta = theta
        self.step = step


class GridMismatchError(FpsolveError, ValueError):
    """An array does not have the shape of the grid.

    Parameters
    ----------
    expected, got : tuple of int
        Shape of the grid and shape of the array.
    name : str, optional
        Name of the argument.
    """

    def __init__(
        self, expected: tuple[int, ...], got: tuple[int, ...], name: str = "p"
    ) -> None:
        super().__init__(
            f"`{name}` must have the shape {expected} of the grid, got {got}."
        )
        self.expected = expected
        self.got = got
        self.name = name


class MemoryLimitError(FpsolveError):
    """A run would need more memory than it may use.

    Parameters
    ----------
    required, available : int
        Memory in bytes.
    remedy : str
        What takes less.
    """

    def __init__(
        self,
        required: int,
        available: int,
        remedy: str = "save fewer densities, choose a coarser grid",
    ) -> None:
        super().__init__(
            f"the run needs {_bytes_text(required)} but {_bytes_text(available)} are "
            f"available; {remedy}, or raise `memory_limit`."
        )
        self.required = required
        self.available = available


class ObservationError(RunError):
    """A function of the caller's own, given as `observe`, gave no finite number.

    Parameters
    ----------
    name : str
        That of the series.
    s : float
        Arclength of the density that it was asked for.
    reason : str
    """

    def __init__(self, name: str, s: float, reason: str) -> None:
        super().__init__(
            f"`observe[{name!r}]` must give a finite number for every density, failed "
            f"at s = {s:g}: {reason.rstrip('.')}; try it on p0 and the grid."
        )
        self.name = name
        self.s = s


class NotRepeatableError(FpsolveError, ValueError):
    """A result does not say how it was made, or was made with a user's own code."""


class CheckpointError(RunError):
    """A checkpoint could not be written, or what it holds cannot be read back.

    What is written last is kept.

    Parameters
    ----------
    path : str or os.PathLike
        File or folder.
    reason : str
        What the operating system says, or what is damaged, without a final full stop.
    remedy : str
        What is kept, and how to go on.
    action : str
        What could not be done.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        reason: str,
        remedy: str,
        *,
        action: str = "written",
    ) -> None:
        super().__init__(
            f"checkpoint `{os.fspath(path)}` cannot be {action}: {reason}; {remedy}."
        )
        self.path = path
        self.reason = reason
        self.remedy = remedy


class CheckpointMismatchError(FpsolveError, ValueError):
    """A folder holds the checkpoint of another run.

    Parameters
    ----------
    directory : str or os.PathLike
        The folder.
    differences : sequence of str
        One for every argument that differs, with both values.
    """

    def __init__(
        self, directory: str | os.PathLike[str], differences: Sequence[str]
    ) -> None:
        super().__init__(
            f"checkpoint `{os.fspath(directory)}` is of another run: "
            f"{', '.join(differences)}; use the arguments of that run, or name "
            "another folder, or remove this one to begin anew."
        )
        self.directory = directory
        self.differences = tuple(differences)


class SteadyStateError(FpsolveError):
    """The search for a stationary density did not converge.

    Parameters
    ----------
    residual : float
        Residual reached.
    tolerance : float
        Residual asked for.
    """

    def __init__(self, residual: float, tolerance: float) -> None:
        super().__init__(
            f"steady state not reached: residual {residual:.2g} exceeds tolerance "
            f"{tolerance:g}; refine the grid, shorten `ds` or enlarge `tolerance`."
        )
        self.residual = residual
        self.tolerance = tolerance


class ToleranceError(FpsolveError):
    """A result could not be computed as accurately as asked for.

    Parameters
    ----------
    reached : float
        Error estimated for the best result that was possible.
    tolerance : float
        Error asked for.
    remedy : str
        What helps.
    """

    def __init__(
        self,
        reached: float,
        tolerance: float,
        remedy: str = "raise `memory_limit` or enlarge `tolerance`",
    ) -> None:
        known = f"the error is estimated at {reached:.2g}"
        if not math.isfinite(reached):
            known = "there is no estimate of the error yet"
        super().__init__(f"tolerance {tolerance:g} not reached: {known}; {remedy}.")
        self.reached = reached
        self.tolerance = tolerance


class ForkedProcessError(FpsolveError, RuntimeError):
    """A kernel was called in a process that was forked from running threads.

    GNU OpenMP, from which numba has its threads on Linux, would end the process or
    wait for ever for threads that a fork does not copy.
    """

    def __init__(self) -> None:
        super().__init__(
            "kernels cannot run in a process that was forked after their threads had "
            "started; start it by `multiprocessing.get_context('spawn')` (or "
            "'forkserver'), for an executor `mp_context=` of the same, or set "
            "NUMBA_THREADING_LAYER=workqueue, whose threads start anew."
        )


class ConfigurationError(FpsolveError):
    """A configuration file asks for something that does not exist or does not fit."""


class FileFormatError(FpsolveError):
    """A file is not what it should be.

    Parameters
    ----------
    path : str or os.PathLike
        The file.
    reason : str
        What is wrong with it, without a final full stop.
    """

    def __init__(self, path: str | os.PathLike[str], reason: str) -> None:
        super().__init__(f"cannot read `{os.fspath(path)}`: {reason}.")
        self.path = path
        self.reason = reason


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


def _half_width_text(half_width: float | tuple[float, float]) -> str:
    if isinstance(half_width, tuple):
        return f"({half_width[0]:g}, {half_width[1]:g})"
    return f"{half_width:g}"


def _bytes_text(n_bytes: int) -> str:
    if n_bytes < 2**30:
        return f"{n_bytes / 2**20:.3g} MiB"
    return f"{n_bytes / 2**30:.3g} GiB"
