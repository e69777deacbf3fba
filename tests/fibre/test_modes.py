"""Small vibrations: hanging chain, cantilever, a column that is about to buckle."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jn_zeros

from fpsolve.fibre import Clamped, Free, Hinged, String, equilibrium, modes

EDGES = (16, 32, 64)
# Roots of cos x cosh x = −1.
CANTILEVER = np.array([1.8751040687119611, 4.694091132974175, 7.854757438237613])
# ρA g L³/EI at which a column falls over: (9/4) j² with j the first zero of J_(−1/3).
GREENHILL = 7.837347438943


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def test_a_hanging_chain_swings_with_zeros_of_the_bessel_function_to_order_two():
    # ω = (j/2) √(g/L), each frequency twice.
    exact = jn_zeros(0, 2) / 2 * math.sqrt(9.81)
    errors = []
    for n in EDGES:
        chain = String(1.0, 1e-3, 1000.0, 0.0, Hinged((0, 0, 0)), Free(), n_edges=n)
        swinging = modes(equilibrium(chain), 4)
        found = swinging.angular_frequencies
        away = np.abs(swinging.squares[::2] - exact**2)
        assert (away <= swinging.errors[::2]).all()
        np.testing.assert_allclose(found[::2], found[1::2], rtol=1e-9)
        errors.append(np.abs(found[::2] / exact - 1))
    assert (abs(orders(errors) - 2) < 0.01).all(), errors
    assert (errors[-1] < [8e-5, 1e-3]).all()


def test_a_cantilever_swings_with_its_frequencies_to_order_two():
    errors = []
    for n in EDGES:
        rod = String(
            1.0, 1e-3, 1000.0, 1e9, Clamped((0, 0, 0), (1, 0, 0)), Free(),
            gravity=(0, 0, 0), n_edges=n,
        )  # fmt: skip
        unit = math.sqrt(rod.bending_stiffness / rod.line_density)
        found = modes(equilibrium(rod), 6).angular_frequencies[::2]
        errors.append(np.abs(found / (unit * CANTILEVER**2) - 1))
    assert (abs(orders(errors) - 2) < 0.05).all(), errors
    assert (errors[-1] < [2.2e-4, 1.1e-3, 2.3e-3]).all()


def test_a_column_buckles_at_greenhills_height_to_order_two():
    weight = 1000.0 * math.pi * 1e-6 / 4 * 9.81

    def slowest(load, n):
        modulus = weight / load * 64 / (math.pi * 1e-12)
        upright = Clamped((0, 0, 0), (0, 0, 1))
        rod = String(1.0, 1e-3, 1000.0, modulus, upright, Free(), n_edges=n)
        return modes(equilibrium(rod), 1).squares[0]

    errors = []
    for n in (8, 16, 32):
        load = brentq(slowest, 7.0, 9.0, args=(n,), xtol=1e-8)
        errors.append(abs(load - GREENHILL))
    assert (abs(orders(errors) - 2) < 0.02).all(), errors
    assert errors[-1] < 4e-3


def test_modes_are_orthogonal_and_keep_the_length():
    chain = String(1.0, 1e-3, 1000.0, 1e8, Hinged((0, 0, 0)), Hinged((0.7, 0, 0)))
    rest = equilibrium(chain)
    found = modes(rest, 5)
    assert found.stable
    inner = np.einsum("aij,i,bij->ab", found.displacements, chain.masses,
                      found.displacements)  # fmt: skip
    np.testing.assert_allclose(inner, np.eye(5), atol=1e-9)
    edges = np.diff(rest.r, axis=0)
    stretched = (np.diff(found.displacements, axis=1) * edges).sum(axis=2)
    size = np.abs(found.displacements).max() * chain.edge
    assert np.abs(stretched).max() < 1e-11 * size
    assert (found.displacements[:, [0, -1]] == 0).all()


def test_what_does_not_swing_has_no_frequency():
    rod = String(
        1.0, 1e-3, 1000.0, 0.0, Hinged((0, 0, 0)), Free(), gravity=(0, 0, -9.81)
    )
    # Upside down: every frequency squared changes its sign.
    shape = np.linspace([0.0, 0, 0], [0, 0, 1.0], rod.n_edges + 1)
    found = modes(equilibrium(rod, shape=shape), 2)
    assert not found.stable
    assert np.isnan(found.frequencies).all()


def test_too_many_edges_for_dense_matrices_are_refused():
    rod = String(1.0, 1e-3, 1000.0, 0.0, Hinged((0, 0, 0)), Free(), n_edges=514)
    with pytest.raises(ValueError, match="at most 512 edges, got 514"):
        modes(equilibrium(rod), 1)
