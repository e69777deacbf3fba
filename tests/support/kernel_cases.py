"""Arguments for every compiled kernel, on a grid of any shape."""

import numpy as np

from fpsolve._kernels import functionals
from fpsolve._kernels.characteristics import N_SCRATCH, Displacement
from fpsolve._kernels.fourier_shift import Direction
from fpsolve.density.schemes.diffusion import ImplicitDiffusion
from fpsolve.density.schemes.fourier_translation import blocked, shift_weights
from fpsolve.density.schemes.rotation import RotationDiffusion
from fpsolve.density.schemes.stencils import flux_taps, shift_taps
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import QuadraticPotential


def at_rest(shape):
    """No displacement between feet."""
    n1, n2, n = shape
    line, plane = np.zeros(n), np.zeros((n1, n2))
    return Displacement(line, line, plane, plane, line, line, 0.0, line, line)


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

    def normal(self, *shape):
        return self.rng.normal(size=shape)

    def smooth_cases(self):
        """Kernels of the curvature, for an even and an odd number of modes in it."""
        n_rows, n = self.n1 * self.n2, self.n
        force = self.normal(2, n_rows)
        waves = np.cos(self.grid.alpha), np.sin(self.grid.alpha)
        forward, backward = self.normal(n, n), self.normal(n, n)
        kicks, mixtures = [], []
        for n_modes in (4, 5):
            u = self.rng.uniform(0.1, 1.0, (n_rows, n_modes, n))
            kicks.append((u, *force, *waves, 0.3, np.zeros_like(u)))
            matrices = self.normal(n // 2, 2 * n_modes, 2 * n_modes)
            mixtures.append((u, forward, matrices, backward, np.zeros_like(u)))
        sums = (
            self.p.reshape(-1, self.n2, n), self.normal(n),
            np.zeros((self.n1, self.n2)), np.zeros((6, self.n1)),
        )  # fmt: skip
        return {
            "turn_modes": [(u[0], waves[0], np.zeros_like(u[0]))],
            "kick": kicks,
            "mix": mixtures,
            "curvature_sums": [sums],
        }

    def shift_cases(self):
        """Kernels of the shift along ξ2, whose cells are even or odd in number."""
        n2, flat = self.n2, self.p.ravel()
        along = Direction(n2, self.n, self.n1, n2 * self.n, self.n)
        at = np.array([0, 2, 3, 5]) * along.stride_beside
        columns = self.normal(n2, 32)
        parts = 2 if n2 % 2 == 0 else 1
        half = n2 // parts
        sources, weights = self.normal(parts, 2 * half, 32), self.normal(parts, half, 8)
        shift = blocked(shift_weights(1.7 * np.sin(self.grid.alpha), n2))
        whole, halves = np.zeros((1, 10, 32)), np.zeros((2, 10, 32))
        five, ten = self.normal(5, 32), self.normal(10, 32)
        return {
            "gather": [(flat, at, along, k, columns.copy()) for k in (8, 3)],
            "scatter": [(columns, at, along, k, flat.copy()) for k in (8, 3)],
            "halve": [(five, whole), (ten, halves)],
            "convolve": [(sources[0], weights[0], half, np.zeros(32))],
            "shift_columns": [(sources, weights, np.zeros((2, 32)), columns.copy())],
            "shift_fourier": [(flat, shift, along, np.zeros(flat.size))],
        }

    def quads(self):
        """Two quads of rows and one array of every shape they are treated in."""
        half, quarter = self.n // 2, -(-self.n // 4)
        rows = self.rng.permutation(self.n1 * self.n2)[:8]
        values, folded = self.normal(self.n, 8), self.normal(2, 2, quarter, 8)
        return rows, values, folded, self.normal(2, half, 8), self.normal(half, 16)

    def turning(self):
        return RotationDiffusion(self.model, self.grid, positive=True)

    def feet_kernel(self, points, limited, *, moves=True, grows=True):
        plane = self.rng.normal(size=(2, self.n1, self.n2))
        line = self.rng.normal(size=(6, self.n))
        return (
            self.p, self.feet, self.growth if grows else np.ones((1, 1, 1)),
            Displacement(*line[:2], *plane, *line[2:4], 0.3, *line[4:]),
            points, limited, self.out() if moves else np.zeros((0, 0, 0)), self.out(),
        )  # fmt: skip

    def sums_kernel(self, logarithms):
        inverse = self.rng.uniform(0.5, 2.0, (self.n1, self.n2))
        inverse = inverse if logarithms else np.ones((1, 1))
        out = np.zeros((functionals.N_FUNCTIONALS, self.n1, self.n2))
        alpha = self.grid.alpha
        return self.p - 0.3, np.cos(alpha), np.sin(alpha), inverse, out

    def rotate_kernel(self, positive, n_nodes=1):
        turn = self.turning()
        table = turn.table(0.1)
        weights = self.rng.uniform(size=(table.matrix_of.size, n_nodes, 4))
        return (
            self.p.reshape(-1, self.n),
            table._replace(
                coefficients=weights,
                matrices=np.repeat(table.matrices, n_nodes, axis=0),
            ),
            turn.direction, turn.transforms, turn.reaction(0.0, 0.1), positive,
            self.out().reshape(-1, self.n),
        )  # fmt: skip

    def cases(self):
        """Name of a kernel: list of argument tuples."""
        p, row, n = self.p, self.p[1], self.n
        rows, values, folded, phases, modes = self.quads()
        direction, transforms = self.turning().direction, self.turning().transforms
        matrices, which = self.normal(3, n // 2, n // 2), np.array([2, 0])
        table = np.stack([matrices, matrices[::-1]])
        one, two = np.ones((2, 1, 4)), self.normal(2, 2, 4)
        wide, sawtooth = np.zeros_like(modes), self.normal(8)
        starts = np.array([3, 0, 2, 5, 1, 4, 6, 2]) * n
        line, ones = self.normal(4, n), np.ones(n)
        lead, padded = 3, self.normal(self.n2 + 7, n)
        scale = self.rng.uniform(size=self.n1 * self.n2)
        flat, plane = p.reshape(-1, n), np.zeros((self.n2, n))
        at = (-3.4, 6.9, 20.2)
        elimination = ImplicitDiffusion(self.model, self.grid).factors(0.3)
        flux, donor = self.fluxes[0]
        work = np.zeros((2, self.n2, n))
        heat = np.exp(-0.3 * np.arange(n // 2) ** 2)
        return {
            "following": [(2, 5), (4, 5)],
            "wrapped": [(-1.0, 5), (-18.0, 6), (3.0, 5), (21.0, 7)],
            "nodes_around": [(2.4,), (3.0,), (3.0 - 1e-12,), (-0.5,)],
            "range_around": [(p, *at), (p, 2.0, 1.0, 2.5)],
            "limit": [(p, self.feet[:, 0, 0], self.rng.uniform(0.0, 2.0, N_SCRATCH))],
            "row_starts": [(5, 7)],
            "interpolate_at_feet": [
                self.feet_kernel(4, False), self.feet_kernel(6, True),
                self.feet_kernel(6, False, moves=False),
                self.feet_kernel(4, True, grows=False),
            ],
            "squared_differences": [(self.normal(n + 7), ones)],
            "read_row": [
                (*line[:3], ones, inverse, self.normal(n + 8), np.zeros(7))
                for inverse in (0.0, 1.7)
            ],
            "make_periodic": [(self.normal(n + 8), n)],
            "row_functionals": [self.sums_kernel(False), self.sums_kernel(True)],
            "row_sums": [(p, np.zeros((self.n1, self.n2)))],
            "scale_rows": [(p, scale.reshape(self.n1, self.n2), self.out())],
            "load_rows": [(flat, rows, values)],
            "store_rows": [(values, rows, scale, np.zeros_like(flat))],
            "fold": [(values, folded, sawtooth)],
            "unfold": [(folded, sawtooth, values)],
            "multiply": [
                (self.normal(6, 7), self.normal(6, 16), 8, add, self.normal(7, 16))
                for add in (False, True)
            ],
            "transform": [(transforms[0], folded, np.zeros_like(folded))],
            "powers": [(direction, rows, phases)],
            "turn_in": [(folded, phases, modes)],
            "turn_out": [(modes, phases, folded)],
            "kick_quads": [
                (modes, which, one, table[:1], wide.copy(), wide.copy()),
                (modes, which, two, table, wide.copy(), wide.copy()),
            ],
            "limit_row": [(row[0] - 0.4,), (row[0].copy(),), (-row[0],)],
            "rotate": [
                self.rotate_kernel(False), self.rotate_kernel(True),
                self.rotate_kernel(False, n_nodes=2),
            ],
            "first_of_group": [
                (np.array(ordered), 1e-13, 1e-20, np.zeros(len(ordered), np.bool_))
                for ordered in ([0.0, 1e-21, 1.0, 1 + 5e-14, 1 + 2e-13, 3.0], [7.0])
            ],
            "rotation_matrices": [
                (line[0, :4], heat, False, np.zeros((4, n // 2, n // 2))),
                (line[0, :4], heat, True, np.zeros((4, n // 2, n // 2))),
            ],
            "moebius_powers": [(0.4, 6, np.zeros((6, 6))), (-1.0, 4, np.zeros((4, 4)))],
            "filter_rows": [(p.ravel(), starts, self.normal(8, n), plane)],
            "filter_planes": [(
                p.ravel(), starts, self.normal(5, n), np.zeros((4, self.n2, n)),
            )],
            "begins": [(1, -2, 6, 5, 10), (7, 3, 4, 7, 8)],
            "wrap_rows": [(lead, self.n2, padded)],
            "translate": [(p, *self.taps, self.out())],
            "clamp_flux": [(row - 0.5, p[2] - 0.3)],
            "plane_fluxes": [(
                p.ravel(), 1, flux, donor, self.n1, plane.copy(), plane.copy(),
            )],
            "transport_rows": [(padded, lead, flux, donor, work, plane)],
            "translate_positive": [(
                p, *self.fluxes[0], *self.fluxes[1], self.out(),
            )],
            "solve_four": [(self.normal(n, 4), *elimination, np.zeros((n, 4)))],
            "solve_rows": [(p, *elimination, self.out())],
            "add_weighted": [
                (p.ravel(), ones[:3] / 3, self.normal(3, p.size), begin)
                for begin in (True, False)
            ],
            **self.smooth_cases(),
            **self.shift_cases(),
        }  # fmt: skip
