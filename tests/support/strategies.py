"""Models, grids, schemes and starts drawn at random, small enough to be run."""

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

from fpsolve import initial
from fpsolve.errors import FpsolveError
from fpsolve.grids.phase_space import PhaseSpaceGrid
from fpsolve.model.curves import (
    EllipticNozzle,
    FixedBelt,
    MovingBelt,
    OscillatingNozzle,
    RotatingNozzle,
)
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials import (
    CallablePotential,
    IsotropicPotential,
    LinearPotential,
    PowerPotential,
    QuadraticPotential,
)


def few(share):
    """Settings with a share of the examples of the profile, for what takes long."""
    return settings(max_examples=max(1, int(share * settings.default.max_examples)))


def between(low, high):
    return st.floats(low, high, allow_nan=False)


def logarithmic_cosine(stiffness):
    """log cosh along the belt, a parabola across: isotropic nowhere."""
    return CallablePotential(
        lambda x, y: np.logaddexp(x, -x) + 0.5 * stiffness * y**2,
        lambda x, y: (np.tanh(x), stiffness * y),
    )


def softened(radius):
    """√(r² + c²): linear far away, without the kink."""
    return IsotropicPotential(
        lambda r: np.hypot(r, radius), lambda r: r / np.hypot(r, radius)
    )


isotropic_potentials = st.one_of(
    st.builds(lambda sigma: QuadraticPotential(sigma, sigma), between(0.7, 1.5)),
    st.builds(LinearPotential, between(0.7, 2.0)),
    st.builds(PowerPotential, between(1.0, 4.0), between(0.8, 1.5)),
    st.builds(softened, between(0.2, 2.0)),
)
named_potentials = st.one_of(
    st.builds(QuadraticPotential, between(0.7, 1.5), between(0.7, 1.5)),
    st.builds(LinearPotential, between(0.7, 2.0)),
    st.builds(PowerPotential, between(1.0, 4.0), between(0.8, 1.5)),
)
potentials = st.one_of(
    named_potentials,
    isotropic_potentials,
    st.builds(logarithmic_cosine, between(0.5, 2.0)),
)
speeds = between(-0.5, 0.5)
angular_speeds = between(-3.0, 3.0)
belts = st.one_of(st.builds(FixedBelt), st.builds(MovingBelt, speeds))
nozzles = st.one_of(
    st.builds(RotatingNozzle, speeds, between(0.0, 1.0), angular_speeds, speeds),
    st.builds(OscillatingNozzle, speeds, between(0.0, 1.0), angular_speeds, speeds),
    st.builds(
        EllipticNozzle, speeds, between(0.0, 1.0), between(0.0, 1.0), angular_speeds
    ),
)
curves = st.one_of(belts, nozzles)
noises = st.one_of(st.just(0.0), between(0.05, 3.0), st.just(20.0))
models = st.builds(LayDownModel, potentials, noises, curves)

cells = st.integers(8, 16)
# The drift-kick scheme needs pairs of angles.
angles = st.integers(3, 8).map(lambda n: 2 * n)
half_widths = st.one_of(
    between(4.0, 8.0), st.tuples(between(4.0, 8.0), between(4.0, 8))
)
grids = st.builds(PhaseSpaceGrid, half_widths, st.tuples(cells, cells, angles))

drift_kick_options = st.fixed_dictionaries(
    {
        "positive": st.booleans(),
        "balanced": st.booleans(),
        "interpolation_order": st.sampled_from([2, 4, 6, 8]),
    }
)
semi_lagrangian_options = st.fixed_dictionaries(
    {
        "form": st.sampled_from(["h", "p"]),
        "splitting": st.sampled_from(["lie", "strang"]),
        "diffusion": st.sampled_from(["backward_euler", "crank_nicolson"]),
        "interpolation_order": st.sampled_from([4, 6]),
        "limited": st.booleans(),
        "adjusted": st.booleans(),
        "compact": st.booleans(),
    }
)
steps = st.sampled_from([1 / 16, 1 / 8, 1 / 4, 1 / 2])


def start(grid, mean1=0.5, mean2=-0.3, concentration=1.0):
    """A density that every box of these grids holds and their cells resolve."""
    return initial.gaussian(
        grid, (mean1, mean2), variance=1.2, angle=0.7, concentration=concentration
    )


starts = st.builds(
    lambda mean1, mean2, concentration: (mean1, mean2, concentration),
    between(-1.0, 1.0), between(-1.0, 1.0), between(0.0, 2.0),
)  # fmt: skip


def outcome(call):
    """(result, None), or (None, the error) if it is one that fpsolve announces."""
    try:
        return call(), None
    except (FpsolveError, ValueError, TypeError, OSError) as error:
        return None, error


# What a user may hand over in the place of a number.
anything = st.recursive(
    st.one_of(
        st.none(),
        st.booleans(),
        st.integers(),
        st.floats(),
        st.complex_numbers(),
        st.text(max_size=5),
        st.binary(max_size=5),
        st.floats().map(np.float64),
        st.complex_numbers().map(np.complex128),
        st.booleans().map(np.bool_),
        st.floats(width=32).map(np.array),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.lists(inner, max_size=3).map(tuple),
        st.dictionaries(st.text(max_size=3), inner, max_size=2),
    ),
    max_leaves=6,
)
