"""Shifts of a density in ξ by an amount that depends on α only.

The weights are stored densely, `weights[t, k]` for tap `first + t` and angle k, so
that neighbouring angles are filtered together, without a gather. A filter makes four
rows at a time: every weight is then read once for four results, which stay in
registers until all taps are added. Rows and planes are addressed by where they begin
in the flat array. Taps come as a pair (first, weights).
"""

import numpy as np
from numba import prange

from fpsolve._kernels.compiling import njit
from fpsolve._kernels.lanes import LANES, put, spread, take

FOUR = 4
PLANES_PER_CHUNK = 8


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def filter_rows(source, starts, weights, out):
    """out[j, k] = Σ_t weights[t, k] source[starts[t] + j n_alpha + k].

    source flat; starts (n_taps,); weights (n_taps, n_alpha); out (n2, n_alpha). Blocks
    overlap where a size is no multiple of theirs.
    """
    n2, n = out.shape
    apart = min(LANES, n - LANES)
    for rows in range(0, n2, FOUR):
        j = min(rows, n2 - FOUR)
        for angles in range(0, n, 2 * LANES):
            k = min(angles, n - LANES - apart)
            m = k + apart
            here = j * n + k
            a = b = c = d = e = f = g = h = spread(0.0)
            for t in range(starts.size):
                at = starts[t] + here
                w, v = take(weights, (t, k)), take(weights, (t, m))
                a = a + w * take(source, (at,))
                e = e + v * take(source, (at + apart,))
                b = b + w * take(source, (at + n,))
                f = f + v * take(source, (at + n + apart,))
                c = c + w * take(source, (at + 2 * n,))
                g = g + v * take(source, (at + 2 * n + apart,))
                d = d + w * take(source, (at + 3 * n,))
                h = h + v * take(source, (at + 3 * n + apart,))
            put(out, (j, k), a)
            put(out, (j, m), e)
            put(out, (j + 1, k), b)
            put(out, (j + 1, m), f)
            put(out, (j + 2, k), c)
            put(out, (j + 2, m), g)
            put(out, (j + 3, k), d)
            put(out, (j + 3, m), h)


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def filter_planes(source, starts, weights, out):
    """out[d, j, k] = Σ_t weights[t, k] source[starts[n_taps − 1 − t + d] + j n + k].

    source flat; starts (n_taps + 3,); weights (n_taps, n_alpha); out (4, n2, n_alpha).
    Four neighbouring planes at once read a third of what they would one by one.
    """
    _, n2, n = out.shape
    apart = min(LANES, n - LANES)
    n_taps = weights.shape[0]
    for j in range(n2):
        for angles in range(0, n, 2 * LANES):
            k = min(angles, n - LANES - apart)
            m = k + apart
            here = j * n + k
            a = b = c = d = e = f = g = h = spread(0.0)
            for t in range(n_taps):
                u = n_taps - 1 - t
                w, v = take(weights, (t, k)), take(weights, (t, m))
                at = starts[u] + here
                a = a + w * take(source, (at,))
                e = e + v * take(source, (at + apart,))
                at = starts[u + 1] + here
                b = b + w * take(source, (at,))
                f = f + v * take(source, (at + apart,))
                at = starts[u + 2] + here
                c = c + w * take(source, (at,))
                g = g + v * take(source, (at + apart,))
                at = starts[u + 3] + here
                d = d + w * take(source, (at,))
                h = h + v * take(source, (at + apart,))
            put(out, (0, j, k), a)
            put(out, (0, j, m), e)
            put(out, (1, j, k), b)
            put(out, (1, j, m), f)
            put(out, (2, j, k), c)
            put(out, (2, j, m), g)
            put(out, (3, j, k), d)
            put(out, (3, j, m), h)


@njit(cache=True, error_model="numpy")
def begins(place, first, count, period, length):
    """Where the rows (or planes) place − first, place − first − 1, … begin; (count,).

    Each is `length` values long; periodic with `period` of them.
    """
    starts = np.empty(count, np.int64)
    for t in range(count):
        starts[t] = ((place - first - t) % period) * length
    return starts


@njit(cache=True, error_model="numpy")
def wrap_rows(lead, n2, rows):
    """Fill the rows before `lead` and from lead + n2 on periodically."""
    for j in range(rows.shape[0]):
        if j < lead or j >= lead + n2:
            source = lead + (j - lead) % n2
            for k in range(rows.shape[1]):
                rows[j, k] = rows[source, k]


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def translate(p, taps1, taps2, out):
    """out[i, j, k] = Σ_t Σ_u w1[t, k] w2[u, k] p[i − t, j − u, k], periodic.

    p, out (n1, n2, n_alpha); weights (n_taps, n_alpha). `out` must not overlap p.
    """
    n1, n2, n = p.shape
    flat = p.reshape(p.size)
    (first1, weights1), (first2, weights2) = taps1, taps2
    n_taps1, n_taps2 = weights1.shape[0], weights2.shape[0]
    lead = max(first2 + n_taps2 - 1, 0)
    n_rows = lead + n2 + max(-first2, 0)
    for block in prange((n1 + FOUR - 1) // FOUR):
        i = FOUR * block
        moved = np.empty((FOUR, n_rows, n))
        planes = begins(i + FOUR - 1, first1, n_taps1 + FOUR - 1, n1, n2 * n)[::-1]
        filter_planes(flat, planes.copy(), weights1, moved[:, lead : lead + n2])
        rows = begins(lead, first2, n_taps2, n_rows, n)
        for d in range(min(FOUR, n1 - i)):
            wrap_rows(lead, n2, moved[d])
            filter_rows(moved[d].reshape(n_rows * n), rows, weights2, out[i + d])


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def clamp_flux(flux, donor):
    """flux ← min(max(flux, 0), donor): no cell gives more than it holds."""
    for j in range(flux.shape[0]):
        for k in range(flux.shape[1]):
            flux[j, k] = min(max(flux[j, k], 0.0), donor[j, k])


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def transport_rows(row, lead, fluxes, donors, work, out):
    """out_j = D_j − (F_{j+½} − F_{j−½}) with F clamped to [0, D_j], periodic in j.

    row (., n_alpha) holds n2 rows from `lead` on and what taps read beside them;
    out (n2, n_alpha); work (2, n2, n_alpha) holds donor cells and fluxes.
    """
    n2, n = out.shape
    n_rows = row.shape[0]
    donor, flux = work[0], work[1]
    flat = row.reshape(row.size)
    first, weights = donors
    filter_rows(flat, begins(lead, first, weights.shape[0], n_rows, n), weights, donor)
    first, weights = fluxes
    filter_rows(flat, begins(lead, first, weights.shape[0], n_rows, n), weights, flux)
    clamp_flux(flux, donor)
    for j in range(n2):
        before = flux[(j - 1) % n2]
        for k in range(n):
            out[j, k] = donor[j, k] - (flux[j, k] - before[k])


@njit(cache=True, fastmath={"contract"}, error_model="numpy")
def plane_fluxes(flat, i, fluxes, donors, n1, donor, flux):
    """Donor cells of plane i and the clamped fluxes to plane i + 1; (n2, n_alpha)."""
    length = donor.size
    first, weights = donors
    filter_rows(flat, begins(i, first, weights.shape[0], n1, length), weights, donor)
    first, weights = fluxes
    filter_rows(flat, begins(i, first, weights.shape[0], n1, length), weights, flux)
    clamp_flux(flux, donor)


@njit(cache=True, parallel=True, fastmath={"contract"}, error_model="numpy")
def translate_positive(p, fluxes1, donors1, fluxes2, donors2, out):
    """The translation in flux form, direction by direction, every flux clamped.

    p, out (n1, n2, n_alpha), p non-negative; fluxes and donors are taps, weights
    (n_taps, n_alpha). Keeps the sum and the sign of p.
    """
    n1, n2, n = p.shape
    flat = p.reshape(p.size)
    last_flux = fluxes2[0] + fluxes2[1].shape[0] - 1
    last_donor = donors2[0] + donors2[1].shape[0] - 1
    lead = max(last_flux, last_donor, 0)
    n_rows = lead + n2 + max(-min(fluxes2[0], donors2[0]), 0)
    n_chunks = (n1 + PLANES_PER_CHUNK - 1) // PLANES_PER_CHUNK
    for chunk in prange(n_chunks):
        start = chunk * PLANES_PER_CHUNK
        donor = np.empty((n2, n))
        moved = np.empty((n_rows, n))
        planes = np.empty((2, n2, n))
        work = np.empty((2, n2, n))
        plane_fluxes(flat, start - 1, fluxes1, donors1, n1, donor, planes[0])
        for i in range(start, min(start + PLANES_PER_CHUNK, n1)):
            before, flux = planes[(i - start) % 2], planes[(i - start + 1) % 2]
            plane_fluxes(flat, i, fluxes1, donors1, n1, donor, flux)
            for j in range(n2):
                for k in range(n):
                    moved[lead + j, k] = donor[j, k] - (flux[j, k] - before[j, k])
            wrap_rows(lead, n2, moved)
            transport_rows(moved, lead, fluxes2, donors2, work, out[i])
