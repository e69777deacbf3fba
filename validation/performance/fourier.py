"""Fourier collocation of the whole right-hand side of (9) with dense matrices.

Independent of fpsolve; the reference and the Fourier peer are built on it.
"""

from __future__ import annotations

import numpy as np
from problem import cell_centres, open_mesh, torque
from scipy.integrate import solve_ivp


def differentiation_matrix(n: int, period: float) -> np.ndarray:
    """d/dx of the trigonometric interpolant on `n` points (the unmatched mode: 0)."""
    wavenumber = 2 * np.pi / period * np.fft.rfftfreq(n, 1 / n)
    if n % 2 == 0:
        wavenumber[-1] = 0.0
    spectrum = 1j * wavenumber[:, None] * np.fft.rfft(np.eye(n), axis=0)
    return np.fft.irfft(spectrum, n, axis=0)


class FourierCollocation:
    """∂ₛp = −τ·∇_ξ p + ∂_α(∇B·τ⊥ p) + (A²/2) ∂_αα p on a periodic box.

    Spectrally accurate as long as p is negligible at the edge of the box, where ∇B
    jumps. An even number of points along every axis.

    Parameters
    ----------
    half_width : float
    shape : tuple of int
        (n1, n2, n_alpha).
    diffusivity : float
        A²/2.
    """

    def __init__(
        self, half_width: float, shape: tuple[int, int, int], diffusivity: float
    ) -> None:
        if any(n % 2 for n in shape):
            raise ValueError(f"`shape` must be even along every axis, got {shape}.")
        self.half_width, self.shape = half_width, shape
        self.diffusivity = diffusivity
        self.axes = cell_centres(half_width, shape)
        mesh = open_mesh(*self.axes)
        self.cosine, self.sine = np.cos(mesh[2]), np.sin(mesh[2])
        self.torque = torque(*mesh)
        self.d1, self.d2 = (
            differentiation_matrix(n, 2 * half_width) for n in shape[:2]
        )
        self.d_alpha = differentiation_matrix(shape[2], 2 * np.pi).T.copy()

    def rate(self, p: np.ndarray) -> np.ndarray:
        """∂ₛp, shape `shape`."""
        n1 = self.shape[0]
        flux = self.torque * p
        if self.diffusivity:
            flux += self.diffusivity * (p @ self.d_alpha)
        rate = flux @ self.d_alpha
        rate -= self.cosine * (self.d1 @ p.reshape(n1, -1)).reshape(p.shape)
        rate -= self.sine * (self.d2 @ p)
        return rate

    def solve(
        self, p0: np.ndarray, s_values: tuple[float, ...], rtol: float
    ) -> list[np.ndarray]:
        """Densities at the ascending `s_values`, started from `p0` at s = 0."""
        run = solve_ivp(
            lambda s, p: self.rate(p.reshape(self.shape)).ravel(),
            (0.0, s_values[-1]),
            p0.ravel(),
            method="DOP853",
            t_eval=s_values,
            rtol=rtol,
            atol=rtol * 1e-2 * p0.max(),
        )
        if not run.success:
            raise RuntimeError(f"The reference failed: {run.message}")
        return [values.reshape(self.shape) for values in run.y.T]
