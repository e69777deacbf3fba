"""Straight fibres on a raster, and what is known of their webs: an oracle for tests."""

import numpy as np
from scipy.integrate import quad

# CV² m x of infinite straight fibres, uniform and isotropic (MATH, section 7): the mean
# of 1/|r - r'| over pairs of points of the unit square, divided by π.
POISSON_LINES = 4 / np.pi * (np.log(1 + np.sqrt(2)) + (1 - np.sqrt(2)) / 3)


def raster(starts, angles, lengths, shape):
    """Laid length in every pixel of side 1, cut exactly where a fibre leaves one.

    Starts are (cross, machine); angles are against the machine direction.
    """
    direction = np.stack((np.sin(angles), np.cos(angles)), axis=1)
    cuts = [np.zeros((len(angles), 1)), lengths[:, None]]
    for axis in (0, 1):
        edges = np.arange(shape[axis] + 1)
        cuts.append((edges - starts[:, axis, None]) / direction[:, axis, None])
    along = np.sort(np.clip(np.concatenate(cuts, axis=1), 0, lengths[:, None]), axis=1)
    pieces, middles = np.diff(along, axis=1), (along[:, 1:] + along[:, :-1]) / 2
    pixels = np.floor(starts[:, :, None] + direction[:, :, None] * middles[:, None])
    pixels = pixels.astype(int)
    inside = np.all((pixels >= 0) & (pixels < np.array(shape)[:, None]), axis=1)
    flat = pixels[:, 0] * shape[1] + pixels[:, 1]
    laid = np.bincount(flat[inside], pieces[inside], shape[0] * shape[1])
    return laid.reshape(shape)


def tiles_of_lines(generator, tiles, side, mean):
    """A web of independent square tiles, each crossed by infinite straight fibres."""
    rows = []
    for _ in range(tiles[0]):
        rows.append(np.hstack([_tile(generator, side, mean) for _ in range(tiles[1])]))
    return np.vstack(rows)


def _tile(generator, side, mean):
    """Lines that are uniform and isotropic: 2 R m of them meet a disc of radius R."""
    radius = side
    n = generator.poisson(2 * radius * mean)
    angles = generator.uniform(0, np.pi, n)
    offsets = generator.uniform(-radius, radius, n)
    normal = np.stack((np.cos(angles), -np.sin(angles)), axis=1)
    direction = np.stack((np.sin(angles), np.cos(angles)), axis=1)
    starts = side / 2 + offsets[:, None] * normal - 2 * radius * direction
    return raster(starts, angles, np.full(n, 4.0 * radius), (side, side))


def web_of_sticks(generator, shape, stick, mean):
    """Straight fibres of a finite length, uniform and isotropic, cut by the window."""
    extent = np.array(shape) + 2 * stick
    n = generator.poisson(mean / stick * extent.prod())
    starts = generator.uniform(0, 1, (n, 2)) * extent - stick
    angles = generator.uniform(0, 2 * np.pi, n)
    return raster(starts, angles, np.full(n, float(stick)), shape)


def stick_variance(zone, stick, mean):
    """CV² = 2/(m ℓ) ∫ (ℓ - r) K(r) dr, K the mean overlap of two squares over x⁴."""

    def overlap(r):
        angle = np.linspace(0, np.pi / 2, 801)
        squares = np.maximum(1 - r / zone * np.cos(angle), 0.0)
        squares = squares * np.maximum(1 - r / zone * np.sin(angle), 0.0)
        return np.trapezoid(squares, angle) / (np.pi / 2) / zone**2

    # Squares at a distance beyond their diagonal do not meet.
    last = min(stick, zone * np.sqrt(2))
    integral, _ = quad(lambda r: (stick - r) * overlap(r), 0, last, epsrel=1e-5)
    return 2 / (mean * stick) * integral


def correlated_field(generator, shape, length):
    """A periodic Gaussian field of variance 1 with the covariance exp(-r²/2ℓ²)."""
    amplitude = np.sqrt(gaussian_power(shape, length) * np.prod(shape))
    noise = np.fft.fft2(generator.standard_normal(shape)) / np.sqrt(np.prod(shape))
    return np.fft.ifft2(noise * amplitude * np.sqrt(np.prod(shape))).real


def gaussian_power(shape, length):
    """The share of each wave of `fft2` in the variance of `correlated_field`."""
    k2, k1 = (2 * np.pi * np.fft.fftfreq(n) for n in shape)
    power = np.exp(-(k2[:, None] ** 2 + k1**2) * length**2 / 2)
    return power / power.sum()
