"""Potentials with known Z: B = −ln Σ wᵢ Nᵢ, mixtures of Gaussian wells, Z = 1."""

import numpy as np

import fpsolve as fp


class Mixture:
    """−ln Σ wᵢ N(mᵢ, Cᵢ) + c and its gradient, without over- or underflow."""

    def __init__(self, weights, means, covariances, constant=0.0):
        self.weights, self.means = np.asarray(weights), np.asarray(means, dtype=float)
        self.covariances = np.asarray(covariances, dtype=float)
        self.precisions = np.linalg.inv(self.covariances)
        determinants = np.linalg.det(self.covariances)
        self.heights = np.log(self.weights / (2 * np.pi * np.sqrt(determinants)))
        self.constant = constant

    def _wells(self, xi1, xi2):
        for height, mean, precision in zip(
            self.heights, self.means, self.precisions, strict=True
        ):
            away1, away2 = xi1 - mean[0], xi2 - mean[1]
            pull1 = precision[0, 0] * away1 + precision[0, 1] * away2
            pull2 = precision[1, 0] * away1 + precision[1, 1] * away2
            yield height - 0.5 * (away1 * pull1 + away2 * pull2), pull1, pull2

    def value(self, xi1, xi2):
        exponents = np.stack([one for one, _, _ in self._wells(xi1, xi2)])
        highest = exponents.max(axis=0)
        total = np.exp(exponents - highest).sum(axis=0)
        return self.constant - highest - np.log(total)

    def gradient(self, xi1, xi2):
        exponents, pulls1, pulls2 = map(
            np.stack, zip(*self._wells(xi1, xi2), strict=True)
        )
        share = np.exp(exponents - exponents.max(axis=0))
        share /= share.sum(axis=0)
        return (share * pulls1).sum(axis=0), (share * pulls2).sum(axis=0)

    def potential(self):
        return fp.CallablePotential(self.value, self.gradient)


def two_wells(distance, share=0.3, width=1.0, constant=0.0):
    """A well of width one at the origin, another at (distance, 0)."""
    return Mixture(
        (share, 1 - share),
        ((0.0, 0.0), (distance, 0.0)),
        (np.eye(2), width**2 * np.eye(2)),
        constant,
    )


def random_mixture(seed):
    """One to four wells, up to sixty times as long as wide, up to a hundred apart."""
    rng = np.random.default_rng(seed)
    k = rng.integers(1, 5)
    size, reach = 10 ** rng.uniform(-3, 3), 10 ** rng.uniform(0, 2)
    turns = rng.uniform(0, np.pi, k)
    cosine, sine = np.cos(turns), np.sin(turns)
    frames = np.moveaxis(np.array([[cosine, -sine], [sine, cosine]]), 2, 0)
    widths = size * 10 ** rng.uniform(-1.3, 0.5, (k, 2))
    covariances = np.einsum("kab,kb,kcb->kac", frames, widths**2, frames)
    constant = rng.choice([0.0, -1e4, -800.0, 800.0, 1e4])
    means = size * reach * rng.normal(size=(k, 2))
    return Mixture(rng.dirichlet(np.ones(k)), means, covariances, constant)
