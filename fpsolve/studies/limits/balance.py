"""Where a belt of any speed takes the mean: the force that holds a von Mises angle."""

from __future__ import annotations

from scipy.optimize import brentq
from scipy.special import i0e, i1e

from fpsolve._support.checks import check_real

__all__ = ["balanced_force"]


def balanced_force(belt_speed: float, noise: float) -> float:
    """|∇B| = A²k/2, I₁(k)/I₀(k) = v: the force at which E cos α = −v.

    With much noise the angle settles while ξ hardly moves, in the von Mises law of
    concentration 2|∇B|/A². On the belt E cos α = −v always, which sets the force. For
    small v it is A²v, that of the hydrodynamic limit; the share that the latter
    misses, v²/2 + O(v⁴), does not fall with the noise.

    Parameters
    ----------
    belt_speed : float
        |v| < 1.
    noise : float

    Raises
    ------
    ValueError
        Unless |v| < 1.

    References
    ----------
    [KMW09]_, remark 3.7, for small v.
    """
    speed = check_real("belt_speed", belt_speed)
    if not abs(speed) < 1:
        raise ValueError(
            f"`belt_speed` must lie strictly between -1 and 1, got {speed:g}; a faster "
            "belt tears the fibre."
        )
    # I₁(k)/I₀(k) > 1 − 1/k from k = 1 on, so this brackets.
    largest = 2.0 + 2.0 / (1.0 - abs(speed))
    found = brentq(lambda k: i1e(k) / i0e(k) - abs(speed), 0.0, largest, xtol=1e-15)
    return 0.5 * noise**2 * float(found) * (1.0 if speed >= 0 else -1.0)
