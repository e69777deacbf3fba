"""Shifts of a density in ξ by an amount that depends on α only.

The weights are stored densely, `weights[t, k]` for tap `first + t` and angle k, so
that the innermost loop runs over the contiguous angle without a gather; taps come
in multiples of three, the group that keeps loads and stores balanced.
"""

import numpy as np
from numba import njit, prange

TAP_GROUP = 3
PLANES_PER_CHUNK = 8


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def filter_rows(row, first, weights, out):
    """out[j, k] = Σ_t weights[t, k] row[j − first − t, k], periodic in j.

    row, out (n2, n_alpha); weights (n_taps, n_alpha), n_taps a multiple of three.
    """
    n2, n_alpha = row.shape
    for j in range(n2):
        for k in range(n_alpha):
            out[j, k] = 0.0
        for t in range(0, weights.shape[0], 3):
            a = row[(j - first - t) % n2]
            b = row[(j - first - t - 1) % n2]
            c = row[(j - first - t - 2) % n2]
            for k in range(n_alpha):
                out[j, k] += (
                    weights[t, k] * a[k]
                    + weights[t + 1, k] * b[k]
                    + weights[t + 2, k] * c[k]
                )


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def filter_planes(p, i, first, weights, out):
    """out[j, k] = Σ_t weights[t, k] p[i − first − t, j, k], periodic in i.

    p (n1, n2, n_alpha); weights (n_taps, n_alpha), n_taps a multiple of three;
    out (n2, n_alpha).
    """
    n1, n2, n_alpha = p.shape
    out[:] = 0.0
    for t in range(0, weights.shape[0], 3):
        a = p[(i - first - t) % n1]
        b = p[(i - first - t - 1) % n1]
        c = p[(i - first - t - 2) % n1]
        for j in range(n2):
            for k in range(n_alpha):
                out[j, k] += (
                    weights[t, k] * a[j, k]
                    + weights[t + 1, k] * b[j, k]
                    + weights[t + 2, k] * c[j, k]
                )


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def translate(p, first1, weights1, first2, weights2, out):
    """out[i, j, k] = Σ_t Σ_u w1[t, k] w2[u, k] p[i − t, j − u, k], periodic.

    p, out (n1, n2, n_alpha); weights (n_taps, n_alpha). `out` must not overlap p.
    """
    n1, n2, n_alpha = p.shape
    for i in prange(n1):
        row = np.empty((n2, n_alpha))
        filter_planes(p, i, first1, weights1, row)
        filter_rows(row, first2, weights2, out[i])


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def clamp_flux(flux, donor):
    """flux ← min(max(flux, 0), donor): no cell gives more than it holds."""
    for j in range(flux.shape[0]):
        for k in range(flux.shape[1]):
            flux[j, k] = min(max(flux[j, k], 0.0), donor[j, k])


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def transport_rows(row, first_flux, fluxes, first_donor, donors, work, out):
    """out_j = D_j − (F_{j+½} − F_{j−½}) with F clamped to [0, D_j], periodic in j.

    row, out (n2, n_alpha); work (2, n2, n_alpha) holds donor cells and fluxes.
    """
    n2, n_alpha = row.shape
    donor, flux = work[0], work[1]
    filter_rows(row, first_donor, donors, donor)
    filter_rows(row, first_flux, fluxes, flux)
    clamp_flux(flux, donor)
    for j in range(n2):
        before = flux[(j - 1) % n2]
        for k in range(n_alpha):
            out[j, k] = donor[j, k] - (flux[j, k] - before[k])


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def translate_positive(
    p, first_flux1, fluxes1, first_donor1, donors1,
    first_flux2, fluxes2, first_donor2, donors2, out,
):  # fmt: skip
    """The translation in flux form, direction by direction, every flux clamped.

    p, out (n1, n2, n_alpha), p non-negative; flux and donor weights
    (n_taps, n_alpha). Keeps the sum and the sign of p.
    """
    n1, n2, n_alpha = p.shape
    n_chunks = (n1 + PLANES_PER_CHUNK - 1) // PLANES_PER_CHUNK
    for chunk in prange(n_chunks):
        start = chunk * PLANES_PER_CHUNK
        donor = np.empty((n2, n_alpha))
        moved = np.empty((n2, n_alpha))
        planes = np.empty((2, n2, n_alpha))
        work = np.empty((2, n2, n_alpha))
        filter_planes(p, start - 1, first_donor1, donors1, donor)
        filter_planes(p, start - 1, first_flux1, fluxes1, planes[0])
        clamp_flux(planes[0], donor)
        for i in range(start, min(start + PLANES_PER_CHUNK, n1)):
            before, flux = planes[(i - start) % 2], planes[(i - start + 1) % 2]
            filter_planes(p, i, first_donor1, donors1, donor)
            filter_planes(p, i, first_flux1, fluxes1, flux)
            clamp_flux(flux, donor)
            for j in range(n2):
                for k in range(n_alpha):
                    moved[j, k] = donor[j, k] - (flux[j, k] - before[j, k])
            transport_rows(
                moved, first_flux2, fluxes2, first_donor2, donors2, work, out[i]
            )
