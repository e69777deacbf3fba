"""Random numbers that depend on (seed, path, step) only.

The noise of path k at step n is Philox under a key made of the seed, at the counter
(k, n): no path knows how many others there are, nor who computes them. The starts of
the paths are drawn in blocks, each from a generator of its own.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fpsolve._support.checks import check_integer

__all__ = ["noise_key", "seed_number", "start_generator"]


def seed_number(seed: Any, rng: Any) -> int:
    """The seed as one number that repeats everything, from either way of giving it.

    Raises
    ------
    TypeError
        If neither or both are given, or one is of a wrong kind.
    ValueError
        If the seed is negative.
    """
    if (seed is None) == (rng is None):
        given = "neither" if seed is None else "both"
        raise TypeError(
            f"exactly one of `seed` and `rng` must be given, got {given}; pass "
            "seed=1 for repeatable paths, or rng=np.random.default_rng() for new ones."
        )
    if rng is not None:
        return int(np.random.default_rng(rng).integers(2**63))
    if isinstance(seed, np.random.SeedSequence):
        return int(seed.generate_state(1, np.uint64)[0])
    return check_integer("seed", seed, 0)


def noise_key(seed: int) -> tuple[int, int]:
    """The two 32-bit words under which the noise is drawn."""
    first, second = np.random.SeedSequence(seed).generate_state(2, np.uint32)
    return int(first), int(second)


def start_generator(seed: int, block: int) -> np.random.Generator:
    """The generator from which a block of paths draws its starts."""
    sequence = np.random.SeedSequence(seed, spawn_key=(block,))
    return np.random.Generator(np.random.Philox(sequence))
