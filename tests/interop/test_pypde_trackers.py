"""py-pde's trackers on our equations and solvers: progress, storage, plots, movies."""

import numpy as np
import pde
import pytest
from PIL import Image
from problems import asymmetric_start

from fpsolve.density.schemes import semi_lagrangian
from fpsolve.density.solve import solve
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.grids.plane import PlaneGrid
from fpsolve.interop import (
    FokkerPlanckPDE,
    GifMovie,
    HydrodynamicPDE,
    entropy_tracker,
    from_pde_field,
    relative_entropy,
    to_pde_field,
)
from fpsolve.model.curves import MovingBelt
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import FreePotential, QuadraticPotential

GRID = PhaseSpaceGrid(5.0, (16, 16, 16))


@pytest.fixture
def p0(model):
    return asymmetric_start(GRID, model.potential)


@pytest.fixture
def field(p0):
    return to_pde_field(p0, GRID)


class TestTrackers:
    """Progress, storage, plots and movies of py-pde, with our scheme as its solver."""

    def solve(self, model, field, tracker, **options):
        options = {"dt": 0.125, "solver": "semi-lagrangian", **options}
        return FokkerPlanckPDE(model).solve(field, 1.0, tracker=tracker, **options)

    def test_the_progress_bar_reaches_the_end(self, model, field, capsys):
        tracker = pde.trackers.ProgressTracker(0.25, fancy=False)
        self.solve(model, field, tracker)
        assert tracker.progress_bar.n == 1.0
        assert "100%" in capsys.readouterr().err

    def test_memory_keeps_what_solve_would_save(self, model, p0, field):
        storage = pde.MemoryStorage()
        self.solve(model, field, storage.tracker(0.5))
        ours = solve(
            semi_lagrangian(model, GRID), p0, (0, 1), 0.125, save_at=[0, 0.5, 1]
        )
        assert storage.times == [0.0, 0.5, 1.0]
        for stored, density in zip(storage, ours.densities, strict=True):
            values, grid = from_pde_field(stored)
            # Ours has gone through h = p/p_S at the start: once to and fro.
            np.testing.assert_allclose(values, density, rtol=5e-16)
            assert grid == GRID

    def test_a_file_gives_the_densities_back(self, model, field, tmp_path):
        pytest.importorskip("h5py")
        path = tmp_path / "laydown.hdf5"
        storage = pde.FileStorage(path, write_mode="truncate")
        final = self.solve(model, field, storage.tracker(0.5))
        storage.close()
        again = pde.FileStorage(path, write_mode="read_only")
        values, grid = from_pde_field(again[-1])
        again.close()
        np.testing.assert_array_equal(values, final.data)
        assert grid == GRID

    def test_plots_show_the_plane_marginal(self, model, field, tmp_path):
        path = tmp_path / "plane.png"
        tracker = pde.PlotTracker(
            0.5, output_file=path, transformation=lambda p: p.project("z")
        )
        self.solve(model, field, tracker)
        with Image.open(path) as image:
            # Something was drawn: many colours on the white background.
            assert len(image.convert("RGB").getcolors(1 << 24)) > 50

    def test_a_movie_has_a_frame_per_interrupt(self, model, field, tmp_path):
        path = tmp_path / "laydown.gif"
        with GifMovie(path, framerate=4, dpi=40) as movie:
            tracker = pde.PlotTracker(
                0.25, movie=movie, show=False, transformation=lambda p: p.project("z")
            )
            self.solve(model, field, tracker)
        with Image.open(path) as image:
            assert image.n_frames == 5

    def test_movies_of_other_formats_are_left_to_py_pde(self):
        with pytest.raises(ValueError, match=r"must end in .gif, got `a.mp4`; use pde"):
            GifMovie("a.mp4")

    def test_a_movie_has_a_whole_positive_rate(self, tmp_path):
        with pytest.raises(ValueError, match="`framerate` must be at least 1, got 0"):
            GifMovie(tmp_path / "a.gif", framerate=0)
        with pytest.raises(TypeError, match=r"`framerate` must be an integer, got 2.5"):
            GifMovie(tmp_path / "a.gif", framerate=2.5)

    def test_a_movie_needs_its_folder(self, tmp_path):
        with pytest.raises(OSError, match="does not exist"):
            GifMovie(tmp_path / "nowhere" / "a.gif")

    def test_the_entropy_is_that_of_our_solution(self, model, p0, field):
        tracker = entropy_tracker(model, 0.25)
        self.solve(model, field, tracker)
        ours = solve(semi_lagrangian(model, GRID), p0, (0, 1), 0.125, record_every=2)
        entropies = [record["relative_entropy"] for record in tracker.data]
        masses = [record["mass"] for record in tracker.data]
        assert tracker.times == list(ours.s)
        # The same sums over the same numbers, in the same order.
        np.testing.assert_allclose(entropies, ours.relative_entropy, rtol=1e-13)
        np.testing.assert_allclose(masses, ours.mass, rtol=1e-13)
        assert list(tracker.dataframe) == ["time", "relative_entropy", "mass"]

    def test_the_entropy_decays_in_the_hydrodynamic_limit(self):
        model = LayDownModel(QuadraticPotential(), 2.0, MovingBelt(0.05))
        grid = PlaneGrid(5.0, (24, 24))
        xi1, xi2 = grid.mesh()
        start = np.exp(-((xi1 - 1) ** 2 + xi2**2)) / np.pi
        equation, tracker = HydrodynamicPDE(model), entropy_tracker(model, 1.0)
        equation.solve(
            to_pde_field(start, grid), 8.0, dt=equation.explicit_step(grid),
            solver="runge-kutta", backend="numpy", tracker=tracker,
        )  # fmt: skip
        entropies = np.array([record["relative_entropy"] for record in tracker.data])
        assert np.all(np.diff(entropies) < 0)
        # Gaussian with mean 1 and variance 1/2 against mean A²v = 0.2, variance 1:
        # H = ½(0.8² + 2·½ − 2 − 2 ln ½); 1.4e-6 of the reference lie beyond the box.
        assert entropies[0] == pytest.approx(0.5 * (0.64 - 1 + np.log(4)), abs=3e-6)

    def test_the_entropy_needs_an_equilibrium(self, field):
        with pytest.raises(ValueError, match="must be normalisable"):
            relative_entropy(field, LayDownModel(FreePotential(), 1.0))
