"""Trackers of py-pde for lay-down densities: entropy, and movies without ffmpeg."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np
from pde.trackers import DataTracker
from pde.visualization.movies import Movie

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_integer, check_path, check_positive
from fpsolve.grids import diagnostics
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop.fields import from_pde_field
from fpsolve.model.laydown import LayDownModel

if TYPE_CHECKING:
    from matplotlib.animation import PillowWriter

__all__ = ["GifMovie", "entropy_tracker", "relative_entropy"]


def relative_entropy(field: Any, model: LayDownModel) -> float:
    """H(p|p_S) = ∫ p ln(p/p_S) of a field, natural logarithm, equation (11).

    In phase space p_S is normalised on R² × [0, 2π), as in `Solution`, and H tends to
    the floor of the grid. In the plane 𝒫_S ∝ exp(−B + A²v ξ₁), the stationary density
    of the hydrodynamic limit, has mass one on the cells, and H tends to zero. Cells
    with p ≤ 0 contribute as in `diagnostics.relative_entropy`.

    Parameters
    ----------
    field : pde.ScalarField
    model : LayDownModel

    Raises
    ------
    TypeError, ValueError
        If the field lives on another kind of grid, see `from_pde_field`, or exp(−B)
        is not integrable.

    References
    ----------
    [KMW09]_, equation (11).
    """
    values, grid = from_pde_field(field)
    if isinstance(grid, PhaseSpaceGrid):
        reference = np.broadcast_to(model.equilibrium(*grid.plane()), grid.shape[:2])
        return diagnostics.relative_entropy(values, grid, reference)
    return _plane_entropy(values, grid, model)


def entropy_tracker(model: LayDownModel, interrupts: Any = 1) -> Any:
    """A tracker that records H(p|p_S) and the mass.

    Works on every run of py-pde with a field of phase space or the plane, whatever the
    solver. Afterwards ``tracker.times`` and ``tracker.data`` hold the records, a
    dictionary "relative_entropy", "mass" each, and ``tracker.dataframe`` a table.

    Parameters
    ----------
    model : LayDownModel
    interrupts : optional
        When to record, as for any tracker of py-pde.

    Returns
    -------
    pde.trackers.DataTracker
    """

    def record(field: Any) -> dict[str, float]:
        entropy = relative_entropy(field, model)
        return {"relative_entropy": entropy, "mass": float(field.integral)}

    return DataTracker(record, interrupts)


class GifMovie(Movie):  # type: ignore[misc]
    """A movie of py-pde written as GIF by pillow, for machines without ffmpeg.

    Give it to ``pde.PlotTracker(movie=...)`` and save it after the run, or use it as a
    context manager around the run. With ffmpeg, py-pde writes other formats by itself.

    Parameters
    ----------
    filename : str or os.PathLike
        Ends in ".gif".
    framerate : int, optional
        Frames per second.
    dpi : float, optional
        Resolution; matplotlib's by default.

    Raises
    ------
    TypeError
        If the rate is not an integer.
    ValueError
        If the name ends otherwise, or the rate is below one.
    OSError
        If the folder does not exist.
    """

    def __init__(
        self,
        filename: str | os.PathLike[str],
        framerate: int = 8,
        dpi: float | None = None,
    ) -> None:
        name = str(check_path("filename", filename))
        if dpi is not None:
            dpi = check_positive("dpi", dpi)
        if not name.endswith(".gif"):
            raise ValueError(
                f"`filename` must end in .gif, got `{name}`; use pde.Movie, which "
                "needs ffmpeg, for other formats."
            )
        super().__init__(name, check_integer("framerate", framerate, 1), dpi)
        self._frames: PillowWriter | None = None

    @classmethod
    def is_available(cls) -> bool:
        """True: pillow comes with matplotlib."""
        return True

    def add_figure(self, fig: Any = None) -> None:
        """Add a figure, by default the current one, as a frame."""
        import matplotlib.pyplot as plt
        from matplotlib.animation import PillowWriter

        fig = plt.gcf() if fig is None else fig
        if self._frames is None:
            self._frames = PillowWriter(fps=self.framerate)
            self._frames.setup(fig, self.filename, dpi=self.dpi)
        self._frames.fig = fig
        self._frames.grab_frame(facecolor="white")

    def save(self) -> None:
        """Write the file; later frames begin another movie."""
        if self._frames is not None:
            self._frames.finish()
        self._frames = None

    def __exit__(self, *failure: object) -> None:
        """Write the file when the block ends."""
        self.save()


def _plane_entropy(density: Array, grid: PlaneGrid, model: LayDownModel) -> float:
    """∫ 𝒫 ln(𝒫/𝒫_S) = ∫ [𝒫 ln(𝒫/𝒫_S) − 𝒫 + 𝒫_S] + M − 1, each cell ≥ 0."""
    from scipy.special import kl_div

    xi1, xi2 = grid.mesh()
    exponent = model.noise**2 * model.belt_speed * xi1 - model.potential.value(xi1, xi2)
    weight = np.exp(exponent - exponent.max())
    reference = weight / (weight.sum() * grid.cell_area)
    cells = kl_div(np.maximum(density, 0.0), np.maximum(reference, 1e-300))
    return float(cells.sum() * grid.cell_area + density.sum() * grid.cell_area - 1.0)
