"""What the large-noise study measures, with the order that is derived for each."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

__all__ = ["Quantity", "quantities_of"]

# Order, order from the start as given, and meaning. The start as given misses the
# displacement of the layer by 2ε Eτ; the direction without p₁ needs no second look.
_MEASURES: dict[str, tuple[float, float | None, str]] = {
    "marginal": (2.0, 1.0, "‖∫p dα − 𝒫‖₁"),
    "joint": (1.0, 1.0, "‖p − 𝒫/2π‖₁"),
    "joint_p1": (2.0, 1.0, "‖p − 𝒫/2π − εp₁‖₁"),
    "mean": (2.0, 1.0, "difference of E ξ"),
    "second_moment": (2.0, 1.0, "difference of E‖ξ‖²"),
    "entropy": (2.0, 1.0, "difference of H(p | e^{−B})"),
    "direction": (1.0, None, "‖E τ‖, which is 0 by 𝒫/2π"),
    "direction_p1": (3.0, 2.0, "difference of E τ with εp₁"),
}
_PLACES = {
    "stationary": "stationary, v = wε",
    "belt_directed": "v = wε, start with a direction",
    "belt_uniform": "v = wε, start uniform in α",
    "rest_directed": "v = 0, start with a direction",
    "rest_uniform": "v = 0, start uniform in α",
    "fixed_speed": "stationary, v fixed",
    "gap": "v = 0",
}
_BALANCE = "E ξ1 against the von Mises balance"


@dataclass(frozen=True)
class Quantity:
    """A distance of the full equation from its limit.

    Attributes
    ----------
    part : str
        Part of the study, see `large_noise_cases.PARTS`.
    measure : str
        Name among the numbers of that part.
    order : float
        Power of ε that is derived for it; NaN for what is exact.
    meaning : str
    """

    part: str
    measure: str
    order: float
    meaning: str

    @property
    def name(self) -> str:
        """Part and measure, as in "stationary/joint_p1"."""
        return f"{self.part}/{self.measure}"


def quantities_of(parts: Iterable[str], *, quadratic: bool) -> list[Quantity]:
    """Everything that some parts measure.

    Parameters
    ----------
    parts : iterable of str
    quadratic : bool
        Whether B is, so that the von Mises balance gives a mean.
    """
    found = []
    for part in parts:
        found += [
            Quantity(part, measure, order, f"{meaning}; {_PLACES[part]}")
            for measure, (order, meaning) in _measures(part, quadratic).items()
        ]
    return found


def _measures(part: str, quadratic: bool) -> dict[str, tuple[float, str]]:
    if part == "gap":
        return {
            "gap": (2.0, "|gap·A²/Λ − 1|"),
            "next_term": (4.0, "|gap·A²/Λ − 1 − cε²|"),
        }
    if part == "fixed_speed":
        return {
            "mean_linear": (0.0, "relative difference of E ξ1 from A²vσ1²"),
            "mean_balance": (2.0, f"relative difference of {_BALANCE}"),
        }
    measures = {name: (order, text) for name, (order, _, text) in _MEASURES.items()}
    if part == "stationary":
        # E cos α = −v, and p₁ has it.
        measures["direction_p1"] = (math.nan, measures["direction_p1"][1])
        if quadratic:
            measures["mean_balance"] = (2.0, f"difference of {_BALANCE}")
    if part.endswith("directed"):
        measures |= {
            f"{name}_uncorrected": (order, f"{text}, start not corrected")
            for name, (_, order, text) in _MEASURES.items()
            if order is not None
        }
    return measures
