"""The shift of the trigonometric interpolant three ways: ours, BLAS, FFT.

    OMP_NUM_THREADS=1 NUMBA_NUM_THREADS=1 python validation/performance/shifts.py

CPU milliseconds of a shift in both directions, medians of 15, and the largest
difference between the three. Half a minute.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
import scipy.fft
from timing import measure

import fpsolve as fp
from fpsolve.density.schemes.fourier_translation import FourierTranslation

SHAPES = (
    *((40, 40, 24), (48, 48, 32), (64, 64, 32), (64, 64, 64), (96, 96, 64)),
    (41, 37, 30),
)
QUICK = ((16, 16, 8), (13, 14, 8))
DS = 0.2


def symbols(shift: np.ndarray, n: int) -> np.ndarray:
    """Phases by which a shift turns the modes; real for the unmatched one."""
    mode = np.fft.fftfreq(n, 1 / n)
    phases = np.exp(-2j * np.pi / n * mode[:, None] * shift)
    if n % 2 == 0:
        phases[n // 2] = phases[n // 2].real
    return phases


def by_blas(p: np.ndarray, shifts: tuple[np.ndarray, ...]) -> Callable[[], np.ndarray]:
    """A matrix for every angle and direction."""
    matrices = []
    for shift, n in zip(shifts, p.shape[:2], strict=True):
        column = np.fft.ifft(symbols(shift, n), axis=0).real
        place = (np.arange(n)[:, None] - np.arange(n)) % n
        matrices.append(np.ascontiguousarray(column[place].transpose(2, 0, 1)))
    left, right = matrices[0], np.ascontiguousarray(matrices[1].swapaxes(1, 2))

    def run() -> np.ndarray:
        planes = np.ascontiguousarray(p.transpose(2, 0, 1))
        moved = np.matmul(np.matmul(left, planes), right)
        return np.ascontiguousarray(moved.transpose(1, 2, 0))

    return run


def by_fft(p: np.ndarray, shifts: tuple[np.ndarray, ...]) -> Callable[[], np.ndarray]:
    """Two transforms there and back, real along the second direction."""
    n1, n2, _ = p.shape
    first, second = symbols(shifts[0], n1), symbols(shifts[1], n2)[: n2 // 2 + 1]
    phases = first[:, None, :] * second[None, :, :]

    def run() -> np.ndarray:
        modes = scipy.fft.fft(scipy.fft.rfft(p, axis=1), axis=0, overwrite_x=True)
        modes *= phases
        modes = scipy.fft.ifft(modes, axis=0, overwrite_x=True)
        moved: np.ndarray = scipy.fft.irfft(modes, n2, axis=1, overwrite_x=True)
        return moved

    return run


def by_us(p: np.ndarray, translate: FourierTranslation) -> Callable[[], np.ndarray]:
    """The operator of the package."""
    out = np.empty_like(p)

    def run() -> np.ndarray:
        translate(p, 0.0, DS, out)
        return out

    return run


def main(arguments: list[str] | None = None) -> None:
    """Print a line for every grid."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="tiny grids")
    shapes = QUICK if parser.parse_args(arguments).quick else SHAPES
    print(f"{'cells':>14} {'ours':>8} {'BLAS':>8} {'FFT':>8}  largest difference")
    for shape in shapes:
        grid = fp.PhaseSpaceGrid(half_width=6.0, shape=shape)
        model = fp.LayDownModel(potential=fp.QuadraticPotential(), noise=1.0)
        translate = FourierTranslation(model, grid)
        p = np.random.default_rng(2008).random(shape)
        shifts = translate.shifts(0.0, DS)
        runs = (by_us(p, translate), by_blas(p, shifts), by_fft(p, shifts))
        found = [measure(run, samples=15) for run in runs]
        apart = max(np.abs(one.value - found[0].value).max() for one in found)
        times = " ".join(f"{1e3 * one.cpu:8.3f}" for one in found)
        print(f"{'x'.join(map(str, shape)):>14} {times}  {apart:.1e}")


if __name__ == "__main__":
    main()
