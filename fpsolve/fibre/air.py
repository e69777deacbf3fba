"""The air around a fibre: how it flows, and how it pulls."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fpsolve._kernels.drag import Drag, drag_slopes
from fpsolve._support.arrays import Array
from fpsolve._support.checks import (
    check_non_negative,
    check_path,
    check_positive,
    keep_checked,
    shown,
)
from fpsolve.fibre.drag import (
    MOST_SLENDERNESS,
    check_slenderness,
    resistance_table,
)
from fpsolve.fibre.ends import Vector, as_vector
from fpsolve.fibre.flow_tables import TableField, fields_of_dataset, fields_of_file

if TYPE_CHECKING:
    import xarray as xr

__all__ = ["AirFlow"]

Field = Callable[[Array, float], Array]


@dataclass(frozen=True)
class AirFlow:
    """u(x, t), ρ and ν of f = ρν (r_n(w) v_n + r_τ(w) v_τ), v = u − ∂_t r; k and ε.

    Parameters
    ----------
    velocity : tuple of float, or callable
        Mean velocity of the air in m/s, the same everywhere, or a function of
        positions, shape (n, 3), and the time that returns velocities of the same shape.
        `AirFlow.from_dataset` and `AirFlow.from_file` make one of a table.
    density : float
        ρ in kg/m³.
    viscosity : float
        Kinematic viscosity ν in m²/s.
    slenderness : float
        Of straight pieces of the fibre, for very slow air; see `drag_resistances`.
    k, dissipation : float, or callable
        Kinetic energy of the fluctuations in m²/s² and ε in m²/s³, of which a
        `TurbulentForce` is made: numbers, or functions of positions and the time that
        return numbers of the shape (n,). 0 is air without turbulence.

    Raises
    ------
    ValueError
        If a number is out of its range, the velocity is neither three numbers nor a
        function, or only one of k and ε is 0.

    References
    ----------
    [KMW09]_, equation (5); [MW11]_.
    """

    _recorded: ClassVar[str] = "air"

    velocity: Vector | Field
    density: float = 1.2
    viscosity: float = 1.5e-5
    slenderness: float = MOST_SLENDERNESS
    k: float | Field = 0.0
    dissipation: float | Field = 0.0

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, "density", "viscosity")
        for name in ("k", "dissipation"):
            if not callable(getattr(self, name)):
                keep_checked(self, check_non_negative, name)
        if (self.k == 0) != (self.dissipation == 0):
            raise ValueError(
                f"`dissipation` must be given with `k`, got {shown(self.dissipation)} "
                f"and {shown(self.k)}; both are 0 without turbulence."
            )
        keep_checked(self, check_slenderness, "slenderness")
        if not callable(self.velocity):
            keep_checked(self, as_vector, "velocity")

    def _recorded_parts(self) -> dict[str, Any]:
        """The parameters; a table or a function stays what it is."""
        return {one.name: getattr(self, one.name) for one in fields(self)}

    @classmethod
    def from_dataset(cls, table: xr.Dataset, **options: Any) -> AirFlow:
        """Flow between the points of a table, by linear interpolation.

        Parameters
        ----------
        table : xarray.Dataset
            Coordinates x, y and z in m; variables velocity_x, velocity_y and velocity_z
            in m/s on them, and perhaps k in m²/s² and dissipation in m²/s³. The
            coordinates are those of a rectilinear grid, or all on one dimension of
            scattered points. One that is left out is one on which the flow does not
            depend, and without a velocity along it that is 0. An attribute `units` of
            any other unit is refused.
        **options
            As for the class: `density`, `viscosity`, `slenderness`.

        Raises
        ------
        ValueError
            If a coordinate or a quantity is missing, not finite, not rising, negative,
            or in another unit, or scattered points are given twice or span no volume.
        """
        return cls(**{**fields_of_dataset(table), **options})

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **options: Any) -> AirFlow:
        """Flow between the points that a CFD code has exported.

        Parameters
        ----------
        path : str or os.PathLike
            A CSV file of scattered points, with a heading as in `x [m], y [m], z [m],
            u [m/s], v [m/s], w [m/s], k [m2/s2], epsilon [m2/s3]`, in any order; SI
            units where none are given, further columns unread. Or a netCDF file as for
            `from_dataset`.
        **options
            As for the class: `density`, `viscosity`, `slenderness`.

        Raises
        ------
        ValueError
            As for `from_dataset`, or if the file has no such heading.
        """
        return cls(**{**fields_of_file(check_path("path", path)), **options})

    def table_errors(self) -> dict[str, float]:
        """What leaving out half of the points of a table changes at most.

        For the velocity in m/s, k and ε: for smooth flows above the error of the
        interpolation, which is of order 2 in the distance of the points. 0 for numbers
        and functions, and infinite for a table with too few points to leave any out.
        """
        fields = {
            name: getattr(self, name) for name in ("velocity", "k", "dissipation")
        }
        return {
            name: field.error if isinstance(field, TableField) else 0.0
            for name, field in fields.items()
        }

    def at(self, r: Array, t: float) -> Array:
        """Velocities at positions r of shape (n, 3), in m/s.

        Raises
        ------
        ValueError
            If the user's function does not return finite numbers of that shape.
        FlowRangeError
            If a position is outside of a table.
        """
        return _values("velocity", self.velocity, r, t, r.shape)

    def turbulence_at(self, r: Array, t: float) -> tuple[Array, Array]:
        """k and ε at positions r of shape (n, 3), shape (n,).

        Raises
        ------
        ValueError
            If a user's function does not return finite numbers of that shape, or one of
            them is negative, or ε is 0 where k is not.
        FlowRangeError
            If a position is outside of a table.
        """
        k = _values("k", self.k, r, t, r.shape[:1])
        dissipation = _values("dissipation", self.dissipation, r, t, r.shape[:1])
        if not ((k >= 0) & (dissipation >= 0) & ((k == 0) | (dissipation > 0))).all():
            raise ValueError(
                "`k` and `dissipation` must be non-negative, and `dissipation` "
                f"positive where `k` is, got {k.min():g} and {dissipation.min():g} at "
                f"t = {t:g}."
            )
        return k, dissipation

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


def _values(name: str, field: Any, r: Array, t: float, shape: tuple[int, ...]) -> Array:
    """Of numbers or a function; ValueError if this returns anything else."""
    if not callable(field):
        return np.broadcast_to(np.array(field), shape)
    found = np.asarray(field(r, t), dtype=np.float64)
    if found.shape != shape or not np.isfinite(found).all():
        raise ValueError(
            f"`{name}` must return finite numbers of the shape {shape}, got "
            f"{shown(found)} at t = {t:g}."
        )
    return found
