"""What a user's own code must be for paths to be the same everywhere."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from fpsolve._support.checks import shown
from fpsolve.model.identity.digests import digest_or_none
from fpsolve.paths.batch import Batch, run_batch
from fpsolve.paths.ensemble import START_BLOCK, Ensemble, GivenStart, checked_sample
from fpsolve.paths.laws import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.paths.randomness import start_generator

__all__ = ["check_repeats", "code_of", "run_there"]

Array = NDArray[np.float64]

# Laws that draw from the generator alone.
KNOWN = (PointLaw, GaussianLaw, EquilibriumLaw, DensityLaw, GivenStart)


def check_repeats(law: Any) -> None:
    """Raise ValueError if a law draws other points from a generator that is the same.

    Path k would then depend on when and where it is drawn, and not on the seed.
    """
    if type(law) in KNOWN:
        return
    (xi, alpha), (xi_again, alpha_again) = (
        checked_sample(law, law.sample(start_generator(0, 0), START_BLOCK))
        for _ in range(2)
    )
    if not (np.array_equal(xi, xi_again) and np.array_equal(alpha, alpha_again)):
        raise ValueError(
            "`initial` must draw from the generator that it is given and from nothing "
            f"else, got two different samples for the same one from {shown(law)}."
        )


def run_there(
    code: str | None, ensemble: Ensemble, first: int, n: int, state: Array | None
) -> Batch:
    """As `run_batch`, in another process: there a name may stand for other code."""
    if code is not None and code_of(ensemble) != code:
        raise RuntimeError(
            "`model`, or `initial`, is other code in the process of `client` than "
            "here, or of another version; restart this process and those of `client` "
            "so that all import the same."
        )
    return run_batch(ensemble, first, n, state)


def code_of(ensemble: Ensemble) -> str | None:
    """The code that decides the paths, as a digest without a machine's rounding."""
    return digest_or_none((Batch, ensemble.model, ensemble.law), sampled=False)
