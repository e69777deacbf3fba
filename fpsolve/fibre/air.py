"""The air around a fibre: how it flows, and how it pulls."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from scipy.interpolate import RegularGridInterpolator

from fpsolve._kernels.drag import Drag, drag_slopes
from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_positive, keep_checked, shown
from fpsolve.errors import FlowRangeError
from fpsolve.fibre.drag import (
    MOST_SLENDERNESS,
    check_slenderness,
    resistance_table,
)
from fpsolve.fibre.ends import Vector, as_vector

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["AirFlow"]

Field = Callable[[Array, float], Array]
# Names of coordinates and velocities in a table of a flow, and their units.
AXES, VELOCITIES = ("x", "y", "z"), ("velocity_x", "velocity_y", "velocity_z")
METRES, METRES_PER_SECOND = {"", "m"}, {"", "m/s", "m s-1", "m s^-1"}


@dataclass(frozen=True)
class AirFlow:
    """u(x, t), ρ and ν of f = ρν (r_n(w) v_n + r_τ(w) v_τ), v = u − ∂_t r.

    Parameters
    ----------
    velocity : tuple of float, or callable
        Mean velocity of the air in m/s, the same everywhere, or a function of
        positions, shape (n, 3), and the time that returns velocities of the same shape.
        `AirFlow.from_dataset` makes one of a table.
    density : float
        ρ in kg/m³.
    viscosity : float
        Kinematic viscosity ν in m²/s.
    slenderness : float
        Of straight pieces of the fibre, for very slow air; see `drag_resistances`.

    Raises
    ------
    ValueError
        If a number is not positive, or the velocity is neither three numbers nor a
        function.

    References
    ----------
    [KMW09]_, equation (5); [MW11]_.
    """

    _recorded: ClassVar[str] = "air"

    velocity: Vector | Field
    density: float = 1.2
    viscosity: float = 1.5e-5
    slenderness: float = MOST_SLENDERNESS

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, "density", "viscosity")
        keep_checked(self, check_slenderness, "slenderness")
        if not callable(self.velocity):
            keep_checked(self, as_vector, "velocity")

    def _recorded_parts(self) -> dict[str, Any]:
        """The parameters; a table or a function stays what it is."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    @classmethod
    def from_dataset(cls, table: xr.Dataset, **options: Any) -> AirFlow:
        """Flow between the points of a rectilinear table, by linear interpolation.

        Parameters
        ----------
        table : xarray.Dataset
            Coordinates x, y and z in m; variables velocity_x, velocity_y and velocity_z
            in m/s on them. An attribute `units` of any other unit is refused.
        **options
            As for the class: `density`, `viscosity`, `slenderness`.

        Raises
        ------
        ValueError
            If a coordinate or a velocity is missing, not finite, not rising, or in
            another unit.
        """
        return cls(_Table.of(table), **options)

    def at(self, r: Array, t: float) -> Array:
        """Velocities at positions r of shape (n, 3), in m/s.

        Raises
        ------
        ValueError
            If the user's function does not return finite numbers of that shape.
        FlowRangeError
            If a position is outside of a table.
        """
        if not callable(self.velocity):
            return np.broadcast_to(np.array(self.velocity), r.shape)
        found = np.asarray(self.velocity(r, t), dtype=np.float64)
        if found.shape != r.shape or not np.isfinite(found).all():
            raise ValueError(
                f"`velocity` must return finite numbers of the shape {r.shape}, got "
                f"{shown(found)} at t = {t:g}."
            )
        return found

    def pull(
        self, diameter: float, velocity: Array, tangent: Array
    ) -> tuple[Array, Array]:
        """Force per length for velocities v of the air past the fibre, and −∂f/∂v.

        Parameters
        ----------
        diameter : float
        velocity, tangent : ndarray, shape (n, 3)
            The tangents of length 1.

        Returns
        -------
        force : ndarray, shape (n, 3)
            In N/m.
        slope : ndarray, shape (n, 3, 3)
            ∂f/∂v, symmetric and positive definite.
        """
        force, slope = np.empty(velocity.shape), np.empty((*velocity.shape, 3))
        drag_slopes(
            self.drag(diameter), np.ascontiguousarray(velocity),
            np.ascontiguousarray(tangent), force, slope,
        )  # fmt: skip
        return force, slope

    def drag(self, diameter: float) -> Drag:
        """Numbers of the drag on a fibre of this diameter in m, for kernels."""
        return Drag(
            *resistance_table(self.slenderness),
            diameter / self.viscosity,
            self.density * self.viscosity,
        )


@dataclass(frozen=True, eq=False)
class _Table:
    """Velocities between the points of a rectilinear table."""

    axes: tuple[Array, Array, Array]
    velocities: Array

    @classmethod
    def of(cls, table: xr.Dataset) -> _Table:
        """Read and checked."""
        missing = [name for name in (*AXES, *VELOCITIES) if name not in table]
        if missing:
            raise ValueError(
                f"`table` must have {', '.join((*AXES, *VELOCITIES))}, without "
                f"{', '.join(missing)}."
            )
        for names, units in ((AXES, METRES), (VELOCITIES, METRES_PER_SECOND)):
            for name in names:
                unit = str(table[name].attrs.get("units", ""))
                if unit not in units:
                    raise ValueError(
                        f"`{name}` of the table must be in {max(units, key=len)}, got "
                        f"{unit}; convert it first."
                    )
        axes = tuple(np.asarray(table[name], dtype=np.float64) for name in AXES)
        velocities = np.stack(
            [table[name].transpose(*AXES).to_numpy() for name in VELOCITIES], axis=-1
        ).astype(np.float64)
        rising = all(one.size > 1 and (np.diff(one) > 0).all() for one in axes)
        if not (rising and np.isfinite(velocities).all()):
            raise ValueError(
                "`table` must have rising coordinates, two at least of each, and "
                "finite velocities."
            )
        return cls((axes[0], axes[1], axes[2]), velocities)

    @cached_property
    def _interpolated(self) -> RegularGridInterpolator:
        return RegularGridInterpolator(self.axes, self.velocities, bounds_error=False)

    def __call__(self, r: Array, t: float) -> Array:
        """Velocities at positions; NaN nowhere, or a FlowRangeError."""
        found = np.asarray(self._interpolated(r))
        outside = ~np.isfinite(found).all(axis=1)
        if outside.any():
            raise FlowRangeError(t, tuple(r[outside.argmax()].tolist()))
        return found
