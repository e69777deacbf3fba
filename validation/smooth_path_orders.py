"""Weak order of the step of smooth paths, for relaxation lengths above and below it.

Ensembles with steps ds, ds/2, … share their noise: that of a long step is composed of
that of the short ones, by the linear equations of κ, α and ∫α. Differences of means on
halving then stand out of the sampling error, and their ratios are two to the order.
"""

from __future__ import annotations

import argparse
import math

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve._kernels import paths as kernels
from fpsolve.paths.integrators import translate
from fpsolve.paths.smooth_step import phi, smooth_step

LENGTHS = (1.0, 0.3, 0.1, 0.03, 0.01, 1e-3, 1e-6)
# Where all steps are on one side of R, so that changes have a power of ds; between, the
# sign of the error changes.
ONE_SIDED = (1.0, 1e-3, 1e-6)
STEPS = (0.4, 0.2, 0.1, 0.05, 0.025)
S_END, NOISE = 2.0, 0.5
# C in |E φ(ds) - E φ(ds/2)| <= C ds² for all R and φ; measured 0.52.
LARGEST = 0.7


class Coupled:
    """Paths of one step length whose noise is common to all."""

    def __init__(self, model: fp.SmoothLayDownModel, ds: float, state: np.ndarray):
        self.model, self.ds, self.state = model, ds, state.copy()
        self.law = smooth_step(model.relaxation_length, model.noise, ds)
        n11, n21, n22, n31, n32, n33 = self.law.noise
        # The third is noise of the mean angle; its integral is what adds up.
        scale = np.array([[1], [1], [ds]])
        self.root = scale * np.array([[n11, 0, 0], [n21, n22, 0], [n31, n32, n33]])
        p0, p1, p2 = (float(phi(k, ds / model.relaxation_length)) for k in range(3))
        self.move = np.array([[p0, 0, 0], [ds * p1, 1, 0], [ds**2 * p2, ds, 1]])
        self.before: np.ndarray | None = None

    def take(self, noise: np.ndarray) -> None:
        """One step with given noise of κ, α and ∫α."""
        numbers, nothing = np.linalg.solve(self.root, noise), np.zeros(2)
        translate(self.state, 0.5 * self.ds, nothing)
        forces = np.stack(self.model.potential.gradient(*self.state[:2]))
        kernels.turn_paths(self.law, numbers, forces, nothing, self.state)

    def joined(self, noise: np.ndarray) -> np.ndarray | None:
        """The noise of a step twice as long, once both halves of it are there."""
        if self.before is None:
            self.before = noise
            return None
        whole, self.before = self.move @ self.before + noise, None
        return whole


def changes(length: float, n_paths: int, seed: int) -> dict[str, np.ndarray]:
    """φ(ds) - φ(ds/2) of every path for some functions φ; (n_steps - 1, n_paths)."""
    model = fp.SmoothLayDownModel(fp.QuadraticPotential(), length, NOISE)
    rng = np.random.default_rng(seed)
    kappa = math.sqrt(model.curvature_variance) * rng.standard_normal(n_paths)
    start = np.array([1.0, 0.5, math.cos(0.7), math.sin(0.7), 0.0])
    state = np.concatenate([np.tile(start[:, None], n_paths), kappa[None]])
    levels = [Coupled(model, ds, state) for ds in STEPS]
    for _ in range(round(S_END / STEPS[-1])):
        noise: np.ndarray | None = levels[-1].root @ rng.standard_normal((3, n_paths))
        for level in reversed(levels):
            if noise is None:
                break
            level.take(noise)
            noise = level.joined(noise)
    xi1, xi2, cosine, sine = np.stack([one.state[:4] for one in levels], axis=1)
    values = {"E xi1": xi1, "E |xi|^2": xi1**2 + xi2**2, "E cos": cosine, "E sin": sine}
    return {name: value[:-1] - value[1:] for name, value in values.items()}


def means(length: float, n_paths: int, n_groups: int) -> dict[str, np.ndarray]:
    """Means of the changes and their standard errors; (2, n_steps - 1) each."""
    groups = [changes(length, n_paths, seed) for seed in range(n_groups)]
    found = {}
    for name in groups[0]:
        of_groups = np.array([group[name].mean(axis=1) for group in groups])
        errors = of_groups.std(axis=0, ddof=1) / math.sqrt(n_groups)
        found[name] = np.stack([of_groups.mean(axis=0), errors])
    return found


def main() -> None:
    """Print the changes for every length, and check their size and their last order."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report = Report("smooth_path_orders", quick)
    n_groups, lengths = (4, (1.0, 0.1, 1e-3)) if quick else (40, LENGTHS)
    rows = []
    largest = 0.0
    for length in lengths:
        for name, (values, errors) in means(length, 10_000, n_groups).items():
            for ds, value, error in zip(STEPS, values, errors, strict=False):
                rows.append({"R": length, "mean": name, "ds": ds, "ds/R": ds / length,
                             "change": value, "standard error": error})  # fmt: skip
                largest = max(largest, (abs(value) - 4 * error) / ds**2)
            clear = np.all(np.abs(values[-2:]) > 20 * errors[-2:])
            if clear and length in ONE_SIDED and name == "E xi1":
                order = math.log2(abs(values[-2] / values[-1]))
                report.check(
                    f"R = {length:g}: order of {name}", abs(order - 2), "<", 0.5
                )
    report.table(rows)
    report.check("all R: largest change / ds^2", largest, "<", LARGEST)
    report.finish()


if __name__ == "__main__":
    main()
