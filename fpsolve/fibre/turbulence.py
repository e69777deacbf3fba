"""The energy of isotropic turbulence over its wave numbers, from k and ε."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq
from scipy.special import i0e, i1e

from fpsolve._support.arrays import Array, check_finite_numbers
from fpsolve._support.checks import check_positive, keep_checked

__all__ = ["FALLING", "RISING", "TurbulenceSpectrum", "bessel_parts", "energy_of"]

# Powers and coefficients of E below the inertial range and beyond it, for which it is
# twice continuously differentiable.
RISING = (np.array([4.0, 5.0, 6.0]), np.array([230.0, -391.0, 170.0]) / 9)
FALLING = (np.array([-7.0, -8.0, -9.0]), np.array([209.0, -352.0, 152.0]) / 9)
# Powers of κ between which the moment is finite: E ~ κ⁴ at 0 and κ⁻⁷ at infinity.
LOWEST, HIGHEST = -5.0, 6.0
# Nodes of a quadrature over ln κ in each of the three parts of E.
PER_PART = 80
# From here on three terms of an expansion in 1/a have twelve digits.
LARGE = 1e4


@dataclass(frozen=True)
class TurbulenceSpectrum:
    """E(κ) = C_K ε^(2/3) κ^(−5/3) for κ₁ ≤ κ ≤ κ₂, ∫ E dκ = k, ∫ κ² E dκ = ε/(2ν).

    Below the inertial range E is E(κ₁) Σ a_j (κ/κ₁)^j with j = 4, 5, 6 and a = (230,
    −391, 170)/9, beyond it E(κ₂) Σ b_j (κ/κ₂)^(−j) with j = 7, 8, 9 and b = (209, −352,
    152)/9, so that it has two continuous derivatives. κ₁ and κ₂ follow from k and ε;
    the solution is unique. The units are SI, or any that fit each other.

    Parameters
    ----------
    k : float
        Kinetic energy of the fluctuations, half their mean square velocity, in m²/s².
    dissipation : float
        ε, in m²/s³.
    viscosity : float
        Kinematic viscosity ν, in m²/s.
    kolmogorov_constant : float
        C_K. The paper's model takes 1/2; spectra measured behind grids are fitted by
        about 1.2 to 1.5 ([Sre95]_).

    Raises
    ------
    ValueError
        If a number is not positive, or k too small for the two conditions: they need
        k ≥ 1.4394 C_K^(3/2) √(νε), where κ₁ = κ₂.

    References
    ----------
    [MW06]_; [MW11]_; [Sre95]_ for the constant.
    """

    k: float
    dissipation: float
    viscosity: float
    kolmogorov_constant: float = 0.5

    def __post_init__(self) -> None:
        keep_checked(self, check_positive, *self.__dataclass_fields__)
        smallest = self._energy_scale * float(energy_of(1.0))
        if not self.k >= smallest:
            raise ValueError(
                f"`k` must be at least {smallest:g}, got {self.k:g}; with less the "
                "`dissipation` and `viscosity` leave no inertial range."
            )

    @property
    def _energy_scale(self) -> float:
        """C_K^(3/2) √(2νε)."""
        dissipated = math.sqrt(2 * self.viscosity * self.dissipation)
        return float(self.kolmogorov_constant**1.5 * dissipated)

    @cached_property
    def inertial_range(self) -> tuple[float, float]:
        """(κ₁, κ₂), in 1/m; to rounding."""
        ratio = _ratio_of(self.k / self._energy_scale)
        left = _DISSIPATED - _DISSIPATED_BELOW * ratio ** (4 / 3)
        scale = 2 * self.viscosity * self.kolmogorov_constant * left
        last = (self.dissipation ** (1 / 3) / scale) ** 0.75
        return ratio * last, last

    @property
    def kolmogorov_length(self) -> float:
        """(ν³/ε)^(1/4), the size of the smallest eddies, in m."""
        return float((self.viscosity**3 / self.dissipation) ** 0.25)

    @property
    def integral_length(self) -> float:
        """∫ f(r) dr = 3π/(4k) ∫ E/κ dκ over the longitudinal correlation f, in m."""
        return 0.75 * math.pi * self.moment(-1) / self.k

    def energy(self, kappa: ArrayLike) -> Array:
        """E(κ) in m³/s²; 0 at κ = 0.

        Parameters
        ----------
        kappa : array_like
            Wave numbers in 1/m, 0 or more.

        Raises
        ------
        ValueError
            If one is negative or not finite.
        """
        kappa = check_finite_numbers("kappa", kappa)
        if not (kappa >= 0).all():
            raise ValueError(
                f"`kappa` must be non-negative, got {kappa.min():g}; it is the modulus "
                "of a wave vector."
            )
        first, last = self.inertial_range
        below = _sum(RISING, np.minimum(kappa / first, 1.0)) * first ** (-5 / 3)
        beyond = _sum(FALLING, np.maximum(kappa / last, 1.0)) * last ** (-5 / 3)
        between = np.clip(kappa, first, last) ** (-5 / 3)
        shape = np.select([kappa < first, kappa > last], [below, beyond], between)
        return np.asarray(self._level * shape)

    def moment(self, power: float) -> float:
        """∫ κ^power E dκ, in closed form.

        Parameters
        ----------
        power : float
            Between −5 and 6, where the integral is finite; 0 gives k, 2 gives ε/(2ν).

        Raises
        ------
        ValueError
            If it is outside.
        """
        if not LOWEST < power < HIGHEST:
            raise ValueError(
                f"`power` must lie between {LOWEST:g} and {HIGHEST:g}, got "
                f"{power:g}; the integral is infinite outside."
            )
        first, last = self.inertial_range
        exponent = power - 2 / 3
        below, beyond = _ends(exponent)
        decades = math.log(last / first)
        # Without the loss of digits near the power 2/3, where it is the logarithm.
        between = decades
        if exponent * decades:
            between = first**exponent * math.expm1(exponent * decades) / exponent
        ends = below * first**exponent + beyond * last**exponent
        return float(self._level * (ends + between))

    def frozen_amplitude(self, speed: ArrayLike) -> Array:
        """√((2π/|w_n|) ∫ E/κ² dκ): white noise that replaces frozen turbulence.

        Eddies that the mean flow carries across a fibre at speed |w_n| without changing
        are correlated over a small part of its length and a short time. What they do
        over longer ones is that of velocities D·dw with a Wiener process w in s and t,
        D D^T = ∫∫ E[u'(s, t) ⊗ u'(0, 0)] ds dt = this squared times (I − b ⊗ b) with b
        the normal to both the fibre and w_n: (2π)² times the integral of the spectral
        tensor E/(4πκ²) (I − κκ^T/κ²) along b, divided by |w_n|.

        Parameters
        ----------
        speed : array_like
            |w_n| in m/s, positive.

        Returns
        -------
        ndarray
            In m^(3/2)/s^(1/2), in the shape of `speed`.

        Raises
        ------
        ValueError
            If a speed is not positive: the eddies that stay where they are keep their
            correlation for ever.
        """
        speed = check_finite_numbers("speed", speed)
        if not (speed > 0).all():
            raise ValueError(
                f"`speed` must be positive, got {speed.min():g}; frozen eddies that do "
                "not pass are no white noise."
            )
        return np.asarray(np.sqrt(2 * math.pi * self.moment(-2) / speed))

    def decaying_amplitudes(self, speed: ArrayLike, decay_time: float) -> Array:
        """White noise that replaces turbulence which passes and decays on the way.

        With the correlation e^{−t²/(2 t_T²)} of an eddy with itself in the frame that
        moves with the flow, a = (κ |w_n| t_T)²/4 and e^{−a} I_n(a) = J_n,

            D² = (2π)^{3/2} t_T/2 ∫ E/κ {J0, (J0 + J1)/2, (J0 − J1)/2} dκ

        along the fibre, along w_n and along the normal of both: the spectral tensor on
        the plane across the fibre, times e^{−2a cos²φ} for waves at φ to the flow. Far
        above the speed of decay these are `frozen_amplitude` twice and 0; air that does
        not pass has finite ones.

        Parameters
        ----------
        speed : array_like
            |w_n| in m/s, 0 or more.
        decay_time : float
            t_T in s, positive; about k/ε.

        Returns
        -------
        ndarray, shape (3, …)
            In m^(3/2)/s^(1/2): along the fibre, along w_n, along their normal; to nine
            digits.

        Raises
        ------
        ValueError
            If a speed is negative, or the time not positive.

        References
        ----------
        [MW11]_.
        """
        speed = check_finite_numbers("speed", speed)
        if not (speed >= 0).all():
            raise ValueError(
                f"`speed` must be non-negative, got {speed.min():g}; it is the modulus "
                "of a velocity."
            )
        time = check_positive("decay_time", decay_time)
        kappa, weights = self._nodes
        even, less = bessel_parts((np.multiply.outer(speed * time, kappa) / 2) ** 2)
        shapes = np.stack([even, even - 0.5 * less, 0.5 * less])
        squares = shapes @ (weights * self.energy(kappa) / kappa)
        squares = (2 * math.pi) ** 1.5 * time / 2 * np.maximum(squares, 0.0)
        return np.asarray(np.sqrt(squares))

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Wave numbers and weights for integrals of E times smooth functions."""
        first, last = np.log(self.inertial_range)
        places, weights = np.polynomial.legendre.leggauss(PER_PART)
        # Beyond these ends E/κ has lost 1e-15 and more of its integral; a part of 1e-13
        # below would be seen along the normal in fast flows.
        kappa, found = [], []
        for low, high in ((first - 12, first), (first, last), (last, last + 5)):
            half = 0.5 * (high - low)
            kappa.append(np.exp(low + half * (places + 1)))
            found.append(half * weights * kappa[-1])
        return np.concatenate(kappa), np.concatenate(found)

    @property
    def _level(self) -> float:
        """C_K ε^(2/3)."""
        return float(self.kolmogorov_constant * self.dissipation ** (2 / 3))


def bessel_parts(a: Array) -> tuple[Array, Array]:
    """J₀ and J₀ − J₁ of J_n = e^{−a} I_n(a), both to twelve digits."""
    even = i0e(a)
    # The difference of two that are nearly the same by its expansion in 1/a.
    large = np.maximum(a, LARGE)
    ahead = (0.5 + (3 / 16 + 45 / 256 / large) / large) / large
    less = np.where(a > LARGE, ahead / np.sqrt(2 * math.pi * large), even - i1e(a))
    return even, less


def _sum(part: tuple[Array, Array], x: Array) -> Array:
    """Σ_j a_j x^j."""
    powers, coefficients = part
    return np.asarray(np.power.outer(x, powers) @ coefficients)


def _ends(exponent: float) -> tuple[float, float]:
    """∫ κ^(exponent + 2/3) E dκ below and beyond, of E(κ_i) = κ_i = 1."""
    below = sum(RISING[1] / (RISING[0] + exponent + 5 / 3))
    beyond = -sum(FALLING[1] / (FALLING[0] + exponent + 5 / 3))
    return float(below), float(beyond)


_ENERGY_BELOW = _ends(-2 / 3)[0] + 3 / 2
_ENERGY_LACKING = 3 / 2 - _ends(-2 / 3)[1]
_DISSIPATED = _ends(4 / 3)[1] + 3 / 4
_DISSIPATED_BELOW = 3 / 4 - _ends(4 / 3)[0]


def energy_of(ratio: float) -> float:
    """K/(C_K^(3/2) √(2νε)) as a function of κ₁/κ₂; it falls."""
    energy = _ENERGY_BELOW * ratio ** (-2 / 3) - _ENERGY_LACKING
    return float(energy * math.sqrt(_DISSIPATED - _DISSIPATED_BELOW * ratio ** (4 / 3)))


def _ratio_of(energy: float) -> float:
    """κ₁/κ₂ of which `energy_of` is this; 1 for the smallest one."""
    if not energy_of(1.0) < energy:
        return 1.0
    # Where a lower bound of it, which falls too, has this value.
    dissipated = math.sqrt(_DISSIPATED - _DISSIPATED_BELOW)
    lowest = (_ENERGY_BELOW / (energy / dissipated + _ENERGY_LACKING)) ** 1.5
    root = brentq(
        lambda x: energy_of(math.exp(x)) - energy, math.log(lowest), 0.0,
        xtol=1e-15, rtol=1e-14,
    )  # fmt: skip
    return math.exp(root)
