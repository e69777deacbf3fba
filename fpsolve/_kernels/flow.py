"""Values of tables: linear on grids in every coordinate, cubic on lines."""

import numpy as np

from fpsolve._kernels.compiling import njit

__all__ = ["between_planes", "cubic_values"]


@njit(cache=True, error_model="numpy")
def _located(planes, x):
    """Number of the last plane up to x that is not the last, and the share beyond it.

    −1 outside; one plane alone holds everywhere.
    """
    low, high = 0, planes.size - 1
    if high == 0:
        return 0, 0.0
    # NaN is outside.
    if not planes[0] <= x <= planes[high]:
        return -1, 0.0
    while high - low > 1:
        middle = (low + high) // 2
        if planes[middle] <= x:
            low = middle
        else:
            high = middle
    return low, (x - planes[low]) / (planes[low + 1] - planes[low])


@njit(cache=True, error_model="numpy")
def between_planes(axes, values, r, out):
    """Values at r (n, 3), into out (n, m); returns the first place outside, or −1.

    There they are NaN. axes: three rising arrays, with one number where nothing depends
    on a coordinate; values (n1, n2, n3, m).
    """
    first, second, third = axes
    outside = -1
    for place in range(r.shape[0]):
        i, x = _located(first, r[place, 0])
        j, y = _located(second, r[place, 1])
        k, z = _located(third, r[place, 2])
        inside = min(i, j, k) >= 0
        for number in range(out.shape[1]):
            out[place, number] = 0.0 if inside else np.nan
        if not inside:
            outside = place if outside < 0 else outside
            continue
        for corner in range(8):
            a, b, c = corner >> 2, (corner >> 1) & 1, corner & 1
            weight = (x if a else 1 - x) * (y if b else 1 - y) * (z if c else 1 - z)
            # Beyond a plane that is alone, or the last, there is none.
            if weight != 0.0:
                for number in range(out.shape[1]):
                    out[place, number] += weight * values[i + a, j + b, k + c, number]
    return outside


@njit(cache=True, error_model="numpy")
def cubic_values(first, step, cubics, x, out):
    """Values at finite x (n,) of cubics between equally spaced places, into out (m, n).

    cubics (4, pieces, m): coefficients from the cube of the distance to the beginning
    of a piece on. Before the first place and behind the last the cubics go on.
    """
    last = cubics.shape[1] - 1
    for i in range(x.size):
        piece = min(max(int((x[i] - first) / step), 0), last)
        away = x[i] - (first + piece * step)
        for number in range(cubics.shape[2]):
            value = cubics[0, piece, number]
            for power in range(1, 4):
                value = value * away + cubics[power, piece, number]
            out[number, i] = value
