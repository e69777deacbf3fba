"""Rates of smooth fibres in polynomials: simple, and another way."""

import math

import numpy as np
from scipy.sparse import csc_array, kron
from scipy.sparse.linalg import eigs


def galerkin_rate(case, parity, sizes, near):
    """The rate next to one in Hermite × Fourier × Hermite polynomials of L.

    The case is (R, A, v, σ2) with σ1 = 1, the parity that under (ξ2, α, κ) → -, the
    sizes are degrees in ξ and α and κ. In Hermite polynomials of e^{-B} and of the
    Gaussian of κ, a lowers, and
    L = (cos α + v) a₁/σ1 + sin α a₂/σ2 + κ ∂_α - F/(Rg) c - c†c/R, κ = g(c + c†).
    """
    length, noise, speed, ratio = case
    degree, harmonics, last = sizes
    cos, sin, turn = trigonometric(harmonics)
    lower1, lower2, across = plane(degree)
    lower = np.diag(np.sqrt(np.arange(1.0, last + 1)), 1)
    deviation = noise / math.sqrt(2 * length)
    here, flat, same = (np.eye(len(one)) for one in (cos, lower1, lower))
    force = lower / (length * deviation)
    generator = (
        product(cos + speed * here, lower1, same)
        + product(sin, lower2 / ratio, same)
        + product(turn, flat, deviation * (lower + lower.T))
        + product(sin, lower1 + lower1.T, force)
        - product(cos, (lower2 + lower2.T) / ratio, force)
        - product(here, flat, lower.T @ lower / length)
    )
    odd = np.r_[np.zeros(harmonics + 1, int), np.ones(harmonics, int)]
    signs = odd[:, None, None] + across[:, None] + np.arange(last + 1)
    kept = np.flatnonzero((signs.ravel() % 2 == 0) == (parity == 1))
    start = np.random.default_rng(0).standard_normal(kept.size)
    found = eigs(generator[kept][:, kept], 1, sigma=-near, v0=start)[0]
    return float(-found[0].real)


def product(*factors):
    """Their Kronecker product."""
    angle, flat, kappa = map(csc_array, factors)
    return csc_array(kron(kron(angle, flat), kappa))


def trigonometric(last):
    """cos α, sin α and ∂_α on 1, √2 cos kα, √2 sin kα."""
    k = np.arange(-last, last + 1)
    # To e^{ikα} and back.
    waves = np.zeros((2 * last + 1, 2 * last + 1), complex)
    waves[last, 0] = 1.0
    for m in range(1, last + 1):
        waves[last + m, m] = waves[last - m, m] = math.sqrt(0.5)
        waves[last + m, last + m] = -1j * math.sqrt(0.5)
        waves[last - m, last + m] = 1j * math.sqrt(0.5)
    up = np.eye(2 * last + 1, k=-1)
    matrices = 0.5 * (up + up.T), -0.5j * (up - up.T), np.diag(1j * k)
    cos, sin, turn = ((waves.conj().T @ one @ waves).real for one in matrices)
    return cos, sin, turn


def plane(degree):
    """What lowers the degree in ξ1 and in ξ2, and the degree in ξ2 of every state."""
    states = [(total - n, n) for total in range(degree + 1) for n in range(total + 1)]
    at = {state: number for number, state in enumerate(states)}
    lower1, lower2 = np.zeros((2, len(states), len(states)))
    for (m, n), number in at.items():
        if m:
            lower1[at[m - 1, n], number] = math.sqrt(m)
        if n:
            lower2[at[m, n - 1], number] = math.sqrt(n)
    return lower1, lower2, np.array([n for _, n in states])
