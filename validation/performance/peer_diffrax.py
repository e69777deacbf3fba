"""Peer: patrick-kidger/diffrax, Euler's method, vectorised over paths and compiled.

float64 as everywhere here. `VirtualBrownianTree` is what its documentation uses;
`UnsafeBrownianPath` is its faster source of increments, good for fixed steps without
gradients. The last variants also change JAX's generator or its precision.
"""

from __future__ import annotations

import os
from collections.abc import Callable
from typing import Any

os.environ["XLA_FLAGS"] = (
    "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1"
)

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
from paths_problem import DS, NOISE, Rate, measure_rate, standard_equilibrium

NAME = "diffrax"
VARIANTS: dict[str, tuple[str, str, bool]] = {
    "VirtualBrownianTree": ("tree", "threefry2x32", True),
    "UnsafeBrownianPath": ("unsafe", "threefry2x32", True),
    "UnsafeBrownianPath, generator unsafe_rbg": ("unsafe", "unsafe_rbg", True),
    "UnsafeBrownianPath, float32": ("unsafe", "threefry2x32", False),
}


def drift(s: Any, state: Any, _: Any) -> Any:
    """(cos α, sin α, ξ₁ sin α − ξ₂ cos α)."""
    cosine, sine = jnp.cos(state[2]), jnp.sin(state[2])
    return jnp.stack([cosine, sine, state[0] * sine - state[1] * cosine])


def diffusion(s: Any, state: Any, _: Any) -> Any:
    """(0, 0, A)."""
    return jnp.array([0.0, 0.0, NOISE], dtype=state.dtype)


def solver(source: str, n_steps: int) -> Callable[[Any, Any], Any]:
    """All end states from all starts and keys, compiled."""
    s_end = n_steps * DS

    def increments(key: Any) -> Any:
        if source == "unsafe":
            return diffrax.UnsafeBrownianPath(shape=(), key=key)
        return diffrax.VirtualBrownianTree(0.0, s_end, tol=DS / 2, shape=(), key=key)

    def end_state(start: Any, key: Any) -> Any:
        terms = diffrax.MultiTerm(
            diffrax.ODETerm(drift), diffrax.ControlTerm(diffusion, increments(key))
        )
        solution = diffrax.diffeqsolve(
            terms, diffrax.Euler(), 0.0, s_end, DS, start,
            saveat=diffrax.SaveAt(t1=True), max_steps=n_steps + 1,
            adjoint=diffrax.DirectAdjoint(),
        )  # fmt: skip
        return solution.ys[0]

    return jax.jit(jax.vmap(end_state))


def rates(*, quick: bool) -> list[Rate]:
    """Rates of all variants; one when quick."""
    n_paths, n_steps = (200, 20) if quick else (20_000, 100)
    variants = dict(list(VARIANTS.items())[1:2]) if quick else VARIANTS
    found = []
    for note, (source, generator, double) in variants.items():
        jax.config.update("jax_enable_x64", double)
        jax.config.update("jax_default_prng_impl", generator)
        solve = solver(source, n_steps)
        start = jnp.asarray(np.stack(standard_equilibrium(n_paths), axis=1))
        keys = jax.random.split(jax.random.key(1), n_paths)

        def sample(solve=solve, start=start, keys=keys):
            end = np.asarray(solve(start, keys).block_until_ready())
            return end[:, 0], end[:, 1]

        found.append(measure_rate(NAME, sample, n_paths, n_steps, note, quick=quick))
    return found
