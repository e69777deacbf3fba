"""What a potential computes, at points of every scale: by this it is known again."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.digests import digest_of, digest_of_answers
from fpsolve.model.potentials.potential import Potential

__all__ = ["digest_of_potential", "digest_of_profile"]

Place = tuple[Array, Array]

# Radii around those of a dimensionless model, in shells of a third of a decade.
_SMALLEST, _LARGEST, _SHELLS, _IN_SHELL = 1e-3, 1e3, 18, 1024
_GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
_ORIGIN = (np.zeros(1), np.zeros(1))


def digest_of_potential(potential: Potential, *places: Place) -> str:
    """Return the SHA-256 of B and ∇B at the origin, on a spiral, and at given places.

    The spiral has 18432 points with radii from 1e-3 to 1e3, each 1.00075 times the one
    before, and angles that never repeat. Seen is therefore every difference along the
    radius that extends over a thousandth of it, and every one in the plane that extends
    over a tenth of the distance from the origin. A smaller one, or one beyond these
    radii, is seen only if it meets one of the given places. Every bit counts, so that
    another machine, whose exponential rounds in another way, may give another digest.

    Parameters
    ----------
    potential : Potential
    *places : pairs of ndarray
        ξ1 and ξ2, which broadcast: the points where it is used, if they are known.
    """
    calls: list[tuple[Any, tuple[Array, ...]]] = []
    for place in (_ORIGIN, *places, *_spiral()):
        calls += [(potential.value, place), (potential.gradient, place)]
    if potential.isotropic:
        for radii in (np.hypot(*shell) for shell in _spiral()):
            calls.append((potential.radial_value, (radii,)))
            calls.append((potential.radial_derivative, (radii,)))
    return digest_of_answers(calls)


def digest_of_profile(potential: Potential) -> str:
    """Return the SHA-256 of B(r) and B'(r) at 2048 radii from 1e-3 to 1e3.

    A hundredth of the work of `digest_of_potential`, for an isotropic potential whose
    functions are known to be the same, while what these refer to may have changed. Of
    one that is not defined at all of these radii it is that of `digest_of_potential`.
    """
    # A user's function raises whatever it likes.
    try:
        with np.errstate(all="ignore"):
            value, derivative = (
                np.broadcast_to(np.asarray(one(_radii()), float), _radii().shape)
                for one in (potential.radial_value, potential.radial_derivative)
            )
    except Exception:
        return digest_of_potential(potential)
    return str(digest_of(np.stack([value, derivative])))


@cache
def _radii() -> Array:
    radii = np.geomspace(_SMALLEST, _LARGEST, 2 * _IN_SHELL)
    radii.flags.writeable = False
    return radii


@cache
def _spiral() -> tuple[Place, ...]:
    """Points of the spiral, shell by shell: a function may be refused in some."""
    n = _SHELLS * _IN_SHELL
    r, angle = np.geomspace(_SMALLEST, _LARGEST, n), _GOLDEN_ANGLE * np.arange(n)
    points = np.stack([r * np.cos(angle), r * np.sin(angle)])
    # A user's function that writes to its arguments must not change the others.
    points.flags.writeable = False
    xi1, xi2 = points.reshape(2, _SHELLS, _IN_SHELL)
    return tuple(zip(xi1, xi2, strict=True))
