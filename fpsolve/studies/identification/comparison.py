"""Both models of one fibre side by side: AIC, goodness of fit, and what they mean."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fpsolve._support.checks import check_real
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.comparison_layout import COMPARISON, MODELS
from fpsolve.studies.identification.goodness import N_SURROGATES, TESTS
from fpsolve.studies.identification.identification import Identification

__all__ = ["IdentificationComparison"]

# The smallest level at which six tests together can reject: each has a share of it.
SMALLEST_LEVEL = len(TESTS) / (1 + N_SURROGATES)
LEVEL = 0.05


@dataclass(frozen=True, eq=False, repr=False)
class IdentificationComparison(Saved):
    """The basic and the smooth model, identified from one fibre, and which is better.

    Two questions have two answers. AIC, where there is a likelihood, says which model
    gives the turns of the fibre the higher probability. The goodness of fit says
    whether fibres of a model are like the given one at all. A model that both prefer
    may be used; where the goodness of fit rejects both, AIC only says which of two
    wrong models is nearer in turns from chord to chord, and the errors of neither hold.

    Attributes
    ----------
    basic, smooth : Identification
    call : Call or None
    provenance : dict

    References
    ----------
    [Aka74]_, [BA02]_.
    """

    kind: ClassVar[str] = "identification-comparison"
    layout = COMPARISON

    basic: Identification
    smooth: Identification
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def identifications(self) -> dict[str, Identification]:
        """Both by the names of the models."""
        return {name: getattr(self, name) for name in MODELS}

    @property
    def data(self) -> FibreCurve:
        """The fibre."""
        return self.basic.data

    @property
    def method(self) -> str:
        """Either "likelihood" or "functional", the same for both."""
        return self.basic.method

    @property
    def aic(self) -> dict[str, float] | None:
        """AIC = 2 n - 2 ln L of each model; None by the functional."""
        found = {name: one.aic for name, one in self.identifications.items()}
        known = {name: aic for name, aic in found.items() if aic is not None}
        return known if len(known) == len(found) else None

    @property
    def aic_difference(self) -> float | None:
        """AIC of the basic less that of the smooth model: positive for the smooth."""
        aic = self.aic
        return None if aic is None else aic["basic"] - aic["smooth"]

    @property
    def weights(self) -> dict[str, float] | None:
        """Akaike weights w_i = exp(-AIC_i/2) / Σ_j exp(-AIC_j/2); None without AIC."""
        aic = self.aic
        if aic is None:
            return None
        least = min(aic.values())
        parts = {name: float(np.exp(0.5 * (least - one))) for name, one in aic.items()}
        return {name: part / sum(parts.values()) for name, part in parts.items()}

    @property
    def p_values(self) -> dict[str, float]:
        """Of the goodness of fit as a whole: min(1, 6 min p) of the six tests of each.

        Bonferroni's: the chance that a true model has a smaller one is at most this.
        """
        return {
            name: min(1.0, len(TESTS) * min(one.p_values.values()))
            for name, one in self.identifications.items()
        }

    def rejected(self, level: float = LEVEL) -> dict[str, tuple[str, ...]]:
        """Models that the goodness of fit rejects, and the tests that do.

        A test rejects where its p-value is at most a sixth of the level, so that a true
        model is rejected with a probability of at most `level`.

        Parameters
        ----------
        level : float, optional
            From 6/129 = 0.0465 on, since 128 surrogates know no smaller p-value than
            1/129, and below 1.

        Raises
        ------
        ValueError
            If the level is another.
        """
        level = check_real("level", level)
        if not SMALLEST_LEVEL <= level < 1:
            raise ValueError(
                f"`level` must be at least {SMALLEST_LEVEL:.4f}, below which "
                f"{N_SURROGATES} surrogates reject nothing, and below 1, got {level:g}."
            )
        found = {}
        for name, one in self.identifications.items():
            bound = level / len(TESTS)
            tests = tuple(test for test, p in one.p_values.items() if p <= bound)
            if tests:
                found[name] = tests
        return found

    @property
    def preferred(self) -> str | None:
        """The model of the smaller AIC; by the functional the only one not rejected.

        None by the functional where both are rejected, or neither.
        """
        aic = self.aic
        if aic is not None:
            return min(aic, key=aic.__getitem__)
        left = [name for name in MODELS if name not in self.rejected()]
        return left[0] if len(left) == 1 else None

    @property
    def best(self) -> Identification:
        """The identification of the preferred model.

        Raises
        ------
        ValueError
            If none is preferred.
        """
        name = self.preferred
        if name is None:
            told = "both" if self.rejected() else "neither"
            raise ValueError(
                "`best` must be preferred by AIC or by the goodness of fit, got the "
                f"functional, which has no AIC, and a fit that rejects {told}; take "
                "`.basic` or `.smooth`, or compare by `method='likelihood'`."
            )
        return self.identifications[name]

    @property
    def verdict(self) -> tuple[str, ...]:
        """What AIC and the goodness of fit at a level of 5 % say, in sentences."""
        return (self._said_by_aic(), *self._said_by_fit())

    def _said_by_aic(self) -> str:
        difference, weights = self.aic_difference, self.weights
        if difference is None or weights is None:
            return "By the functional there is no likelihood, and no AIC."
        name = self.preferred
        assert name is not None
        return (
            f"AIC prefers the {name} model, by {abs(difference):.2f} (weight "
            f"{weights[name]:.3g})."
        )

    def _said_by_fit(self) -> list[str]:
        rejected = self.rejected()
        if not rejected:
            return ["The goodness of fit rejects neither model."]
        if len(rejected) == 1:
            ((name, tests),) = rejected.items()
            said = f"The goodness of fit rejects the {name} model: {', '.join(tests)}."
            contrary = self.aic is not None and name == self.preferred
            return [said, _CONTRARY] if contrary else [said]
        told = "; ".join(f"{name}: {', '.join(own)}" for name, own in rejected.items())
        both = f"The goodness of fit rejects both models ({told})."
        return [both, *([] if self.aic is None else [_BOTH]), _ERRORS]

    def __repr__(self) -> str:
        told = " ".join(self.verdict)
        return f"IdentificationComparison({self.method}; {told})"


_CONTRARY = (
    "AIC prefers the rejected model for its turns from chord to chord; look at what is "
    "rejected before you use it."
)
_BOTH = (
    "AIC then only says which of two wrong models gives the turns from chord to chord "
    "the higher probability, not that it may be used."
)
_ERRORS = (
    "Standard errors and intervals are those of the models' own fibres, and hold for "
    "neither; compare what both predict with what is measured."
)
