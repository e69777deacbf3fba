"""Arguments for every compiled kernel, on a grid of any shape."""

import numpy as np

from fpsolve._kernels import functionals
from fpsolve.grids import PhaseSpaceGrid
from fpsolve.models import LayDownModel
from fpsolve.potentials import QuadraticPotential
from fpsolve.schemes.diffusion import ImplicitDiffusion
from fpsolve.schemes.rotation import RotationDiffusion
from fpsolve.schemes.stencils import flux_taps, shift_taps


class Arguments:
    """Arguments of every kernel on one grid: random, positive, seeded."""

    def __init__(self, shape):
        self.rng = np.random.default_rng(2008)
        self.n1, self.n2, self.n = shape
        self.shape = shape
        self.p = self.rng.uniform(0.1, 1.0, shape)
        self.grid = PhaseSpaceGrid(3.0, shape)
        self.model = LayDownModel(QuadraticPotential(1.0, 0.8), 0.7)
        # Shifts of more than a cell to either side.
        shift = 1.7 * np.cos(self.grid.alpha), 1.7 * np.sin(self.grid.alpha)
        self.taps = [shift_taps(part, 4) for part in shift]
        self.fluxes = [flux_taps(part, 4) for part in shift]
        # Feet on both sides of every boundary.
        self.feet = self.rng.uniform(-9.0, 25.0, (3, *shape))
        self.growth = self.rng.normal(size=shape)

    def out(self):
        return np.zeros(self.shape)

    def rows(self, n_rows=5):
        half = self.n // 2
        random = self.rng.uniform(-1.0, 1.0, (4, n_rows, half))
        return *random, self.rng.permutation(self.n1 * self.n2)[:n_rows]

    def turning(self):
        return RotationDiffusion(self.model, self.grid, positive=True)

    def feet_kernel(self, limited):
        return self.p, self.feet, self.growth, 6, limited, self.out()

    def perturbed_kernel(self, points, limited, growth):
        plane = self.rng.normal(size=(2, self.n1, self.n2))
        line = self.rng.normal(size=(6, self.n))
        return (
            self.p, self.feet, growth, line[0], line[1], plane[0], plane[1], line[2],
            line[3], 0.3, line[4], line[5], points, limited, True, self.out(),
        )  # fmt: skip

    def rotate_kernel(self, positive, n_nodes=1):
        turn = self.turning()
        table = turn.table(0.1)
        weights = self.rng.uniform(size=(table.rows.size, n_nodes))
        return (
            self.p.reshape(-1, self.n), table.rows, table.matrix_of, weights,
            np.repeat(table.matrices, n_nodes, axis=0), turn.phases, table.damping,
            turn.reaction(0.0, 0.1), *turn.transforms, positive,
            self.out().reshape(-1, self.n),
        )  # fmt: skip

    def cases(self):
        """Name of a kernel: list of argument tuples."""
        p, row, n = self.p, self.p[1], self.n
        first, weights = self.taps[0]
        even, odd, cosine, sine, rows = self.rows()
        phases = self.turning().phases
        modes = self.rng.normal(size=(5, 2, n // 2))
        matrices = self.rng.normal(size=(3, n // 2, n // 2))
        which = np.array([0, 0, 1, 2, 2])
        table = np.stack([matrices, matrices[::-1]])
        number, sawtooth = self.rng.uniform(size=(5, 2)), self.rng.normal(size=5)
        scale = self.rng.uniform(size=self.n1 * self.n2)
        flat, plane = p.reshape(-1, n), np.zeros((self.n2, n))
        four, six = np.array([5, 6, 7, 0]), np.array([5, 6, 7, 0, 1, 2])
        four_weights, six_weights = self.rng.normal(size=(2, 6))
        at = (-3.4, 6.9, 20.2)
        elimination = ImplicitDiffusion(self.model, self.grid).factors(0.3)
        flux, donor = self.fluxes[0]
        work = np.zeros((2, self.n2, n))
        none = np.zeros((1, 1, 1))
        heat = np.exp(-0.3 * np.arange(n // 2) ** 2)
        return {
            "following": [(2, 5), (4, 5)],
            "wrapped": [(-1.0, 5), (-18.0, 6), (3.0, 5), (21.0, 7)],
            "four_from": [(-1.0, 5), (3.0, 5), (12.0, 7)],
            "cubic_weights": [(0.0,), (0.3,), (0.999,)],
            "quintic_weights": [(0.0,), (0.3,), (0.999,)],
            "wrapped_line": [(row[0], four, four_weights)],
            "wrapped_plane": [(row, four % self.n2, four, six_weights, four_weights)],
            "plane_sums": [(row, four % self.n2, 2, six_weights)],
            "value_cubic": [(p, *at), (p, 0.0, 1.0, 2.0)],
            "line_quintic": [(row[0], six, six_weights)],
            "value_quintic": [(p, *at), (p, 0.0, 1.0, 2.0)],
            "clipped": [(p, *at, 0.5), (p, *at, 9.0), (p, *at, -9.0)],
            "value_at": [(p, *at, 4, False), (p, *at, 6, True)],
            "interpolate_at_feet": [
                (p, self.feet, none, 4, False, self.out()),
                self.feet_kernel(False), self.feet_kernel(True),
            ],
            "interpolate_at_perturbed_feet": [
                self.perturbed_kernel(4, False, none),
                self.perturbed_kernel(6, True, self.growth),
            ],
            "blend": [(p, p[::-1].copy(), 0.3, self.out())],
            "squared_differences": [(self.rng.normal(size=n + 7), n)],
            "row_functionals": [(
                p - 0.3, np.cos(self.grid.alpha), np.sin(self.grid.alpha),
                np.zeros((self.n1, self.n2, functionals.N_FUNCTIONALS)),
            )],
            "row_sums": [(p, np.zeros((self.n1, self.n2)))],
            "scale_rows": [(p, scale.reshape(self.n1, self.n2), self.out())],
            "fold": [(flat, rows, even, odd, sawtooth)],
            "unfold": [(even, odd, sawtooth, rows, scale, np.zeros_like(flat))],
            "turn_in": [(cosine, sine, phases, rows, np.zeros_like(modes))],
            "turn_out": [(modes, phases, rows, cosine, sine)],
            "multiply_groups": [(modes, which, matrices, np.zeros_like(modes))],
            "multiply_interpolated": [
                (modes, which, number, table, np.zeros_like(modes)),
            ],
            "limit_row": [(row[0] - 0.4,), (row[0].copy(),), (-row[0],)],
            "rotate": [
                self.rotate_kernel(False), self.rotate_kernel(True),
                self.rotate_kernel(False, n_nodes=2),
            ],
            "rotation_matrices": [
                (cosine[0], heat, False, np.zeros((n // 2, n // 2, n // 2))),
                (cosine[0], heat, True, np.zeros((n // 2, n // 2, n // 2))),
            ],
            "moebius_powers": [(0.4, 6, np.zeros((6, 6))), (-1.0, 4, np.zeros((4, 4)))],
            "filter_rows": [(row, first, weights, plane)],
            "filter_planes": [(p, 2, first, weights, plane)],
            "translate": [(p, *self.taps[0], *self.taps[1], self.out())],
            "clamp_flux": [(row - 0.5, p[2] - 0.3)],
            "transport_rows": [(row, *flux, *donor, work, plane)],
            "translate_positive": [(
                p, *self.fluxes[0][0], *self.fluxes[0][1], *self.fluxes[1][0],
                *self.fluxes[1][1], self.out(),
            )],
            "eliminate": [(elimination.pivots, elimination.off, row[0].copy())],
            "solve_rows": [(p, *elimination, self.out())],
        }  # fmt: skip
