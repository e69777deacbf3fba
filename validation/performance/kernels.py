"""Rates of the operators our schemes are made of, against the machine's limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from machine import BYTES_PER_COPIED_VALUE, Machine
from ours import case, make_scheme, make_start
from timing import measure

DS = 1 / 8
N_STEPS = 8


@dataclass(frozen=True)
class KernelRate:
    """What one operator attains.

    Attributes
    ----------
    name : str
    cells_per_second : float
        Cells of the density treated per CPU second.
    flops_per_cell : float or None
        Of matrix products and interpolation filters, where they are what bounds it.
    """

    name: str
    cells_per_second: float
    flops_per_cell: float | None

    def shares(self, machine: Machine) -> dict[str, float | None]:
        """Fractions of copying the density, of copying from memory, and of DGEMM."""
        moved = self.cells_per_second * BYTES_PER_COPIED_VALUE
        flops = self.flops_per_cell
        product = None if flops is None else self.cells_per_second * flops
        return {
            "copy_density": moved / machine.copy_density,
            "copy_large": moved / machine.copy_large,
            "dgemm": None if product is None else product / machine.dgemm,
        }


def rotation_flops(n_alpha: int, n_matrices: int) -> float:
    """Operations per cell of the angle step, matrix products only.

    Per row of n_alpha = 2M = 4H cells: eight cosine or sine transforms of H values, 2H²
    each, and n_matrices products of the real and the imaginary part with an M x M
    matrix.
    """
    half = n_alpha // 2
    quarter = -(-half // 2)
    return (8 * 2 * quarter**2 + n_matrices * 2 * 2 * half**2) / n_alpha


def filter_flops(order: int) -> float:
    """Operations per cell of two one-dimensional filters of `order` taps."""
    return 2 * 2 * order


def drift_kick_rates(shape: tuple[int, int, int]) -> list[KernelRate]:
    """Translation (both forms), angle step and whole steps of `drift_kick`."""
    plain = make_scheme(case("drift_kick", shape, DS))
    positive = make_scheme(case("drift_kick", shape, DS, positive=True))
    fourier = make_scheme(case("drift_kick", shape, DS, translation="fourier"))
    p = make_start(plain.grid)
    out = np.empty_like(p)
    plain.kick(p, 0.0, DS, out)
    n_matrices = plain.kick.table(DS).coefficients.shape[1]
    order = plain.interpolation_order
    return [
        rate(
            f"translation in ξ, order {order}",
            p.size,
            lambda: plain.translate(p, 0.0, DS, out),
            filter_flops(order),
        ),
        rate(
            f"translation in ξ, order {order}, positive",
            p.size,
            lambda: positive.translate(p, 0.0, DS, out),
        ),
        rate(
            "translation in ξ, Fourier",
            p.size,
            lambda: fourier.translate(p, 0.0, DS, out),
        ),
        rate(
            "rotation and diffusion in α",
            p.size,
            lambda: plain.kick(p, 0.0, DS, out),
            rotation_flops(shape[2], n_matrices),
        ),
        whole_step("drift_kick", plain, p),
        whole_step("drift_kick (positive)", positive, p),
        whole_step("drift_kick (Fourier)", fourier, p),
    ]


def semi_lagrangian_rates(shape: tuple[int, int, int]) -> list[KernelRate]:
    """Characteristics, implicit diffusion and whole steps of `semi_lagrangian`."""
    scheme = make_scheme(case("semi_lagrangian", shape, DS))
    p = make_start(scheme.grid)
    state = scheme.start(p)
    out = np.empty_like(p)
    return [
        rate(
            "adjusted characteristics",
            p.size,
            lambda: scheme.transport(state, 0.0, DS),
        ),
        rate(
            "implicit diffusion in α",
            p.size,
            lambda: scheme.diffuse(p, 0.0, DS, out),
        ),
        whole_step("semi_lagrangian", scheme, p),
    ]


def whole_step(name: str, scheme: object, p: np.ndarray) -> KernelRate:
    """Rate of complete steps, records excluded."""
    cells = p.size * N_STEPS
    run = measured_steps(scheme, p)
    return rate(f"whole step, {name}", cells, run)


def measured_steps(scheme: object, p: np.ndarray) -> Callable[[], None]:
    """Return a call that makes N_STEPS steps from p."""

    def run() -> None:
        scheme.advance(scheme.start(p), 0.0, DS, N_STEPS)  # type: ignore[attr-defined]

    return run


def rate(
    name: str, cells: int, call: Callable[[], object], flops: float | None = None
) -> KernelRate:
    """Measure one operator; compiled and warm after the first call."""
    call()
    return KernelRate(name, cells / measure(call).cpu, flops)


def measure_kernels(*, quick: bool = False) -> list[KernelRate]:
    """All rates, on 64³ (a smaller grid if `quick`)."""
    shape = (32, 32, 32) if quick else (64, 64, 64)
    return drift_kick_rates(shape) + semi_lagrangian_rates(shape)
