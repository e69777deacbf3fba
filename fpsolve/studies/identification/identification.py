"""What was identified: parameters, their errors, the model, and how well it fits."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve._support.checks import check_real
from fpsolve.evolution.call import Call
from fpsolve.evolution.saved import Saved
from fpsolve.model.fibre import FibreModel
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.studies.identification.coordinates import FUNCTIONAL, LIKELIHOOD
from fpsolve.studies.identification.coordinates import interval as even_interval
from fpsolve.studies.identification.layout import IDENTIFICATION

if TYPE_CHECKING:
    from fpsolve.web.prediction import WebPrediction

__all__ = ["Identification"]


@dataclass(frozen=True, eq=False, repr=False)
class Identification(Saved):
    """Parameters of a lay-down model from a fibre curve, with what is known of them.

    Attributes
    ----------
    model : LayDownModel or SmoothLayDownModel
        With the parameters found and the reference curve of the fibre.
    data : FibreCurve
        The fibre.
    method : str
        "functional" or "likelihood".
    parameters : dict of float
        "sigma1", "sigma2", "noise" (A = RK) and, of the smooth model, also
        "curvature_noise" (K), in powers of the unit of length of the fibre.
    covariance : ndarray, shape (n, n)
        Of the parameters in their order.
    log_likelihood : float or None
        Where the method has one.
    history : ndarray, shape (n_iterations, n)
        Parameters of every iteration.
    k_max : int
        Longest lag of the increments, in steps.
    h : ndarray, shape (n_lags,)
        Lags k Δs.
    angle_bands, curvature_bands : ndarray, shape (4, n_lags)
        Γ_α and Γ_κ: of the fibre, mean of the surrogates, and the limits between which
        95 % of them lie.
    p_values : dict of float
        Goodness of fit, by what is compared: share of the model's own fibres of this
        size that are as far from their mean.
    undetermined : dict of str
        Parameters that the fibre cannot determine, and why.
    notes : tuple of str
    call : Call or None
    provenance : dict
    """

    kind: ClassVar[str] = "identification"
    layout = IDENTIFICATION

    model: FibreModel
    data: FibreCurve
    method: str
    parameters: dict[str, float]
    covariance: Array
    log_likelihood: float | None
    history: Array
    k_max: int
    h: Array
    angle_bands: Array
    curvature_bands: Array
    p_values: dict[str, float]
    undetermined: dict[str, str] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    call: Call | None = None
    provenance: dict[str, Any] = field(default_factory=dict)

    @property
    def standard_errors(self) -> dict[str, float]:
        """Square roots of the variances of the parameters."""
        errors = np.sqrt(np.diag(self.covariance)).tolist()
        return dict(zip(self.parameters, errors, strict=True))

    @property
    def aic(self) -> float | None:
        """2 n - 2 log L: the smaller one of two models of the same fibre is better."""
        if self.log_likelihood is None:
            return None
        return 2.0 * len(self.parameters) - 2.0 * self.log_likelihood

    def interval(self, level: float = 0.95) -> dict[str, tuple[float, float]]:
        """Intervals that hold a true parameter with that probability.

        ± z errors in 1/σ² for throwing ranges by likelihood, in 1/σ by the functional,
        in which either is even, up to infinity; in logarithms for noises,
        P exp(±z δP/P).

        Parameters
        ----------
        level : float, optional
            Between 0 and 1.

        Raises
        ------
        ValueError
            If the level is not between 0 and 1.
        """
        from scipy.special import ndtri

        level = check_real("level", level)
        if not 0 < level < 1:
            raise ValueError(f"`level` must lie between 0 and 1, got {level:g}.")
        z, errors = float(ndtri(0.5 + 0.5 * level)), self.standard_errors
        power = LIKELIHOOD if self.method == "likelihood" else FUNCTIONAL
        return {
            name: even_interval(name, value, errors[name], z, power)
            for name, value in self.parameters.items()
        }

    def cv_errors(self, prediction: WebPrediction) -> Array:
        """√(g Σ gᵀ): standard errors of predicted CV by the errors of the parameters.

        g = ∂CV/∂(σ1, σ2, A), of smooth fibres also in K, from
        `predict_web(identification.model, …, gradients=True)`, Σ the covariance; see
        `carried.carried_errors`.

        Parameters
        ----------
        prediction : WebPrediction

        Returns
        -------
        ndarray, shape (n_zones,)

        Raises
        ------
        ValueError
            If the prediction is without gradients or of another model, or a parameter
            not determined to 30 per cent.
        """
        from fpsolve.studies.identification.carried import carried_errors

        return carried_errors(self, prediction)

    def carry_errors(self, prediction: WebPrediction) -> WebPrediction:
        """The prediction with `carried_errors`, stored with it: those of `cv_errors`.

        Parameters
        ----------
        prediction : WebPrediction

        Returns
        -------
        WebPrediction

        Raises
        ------
        ValueError
            As `cv_errors`.
        """
        return replace(prediction, carried_errors=self.cv_errors(prediction))

    def __repr__(self) -> str:
        errors = self.standard_errors
        told = ", ".join(
            f"{name} = {value:.4g} ± {errors[name]:.1g}"
            for name, value in self.parameters.items()
        )
        worst = min(self.p_values, key=self.p_values.__getitem__)
        return (
            f"Identification({self.method}: {told}; smallest p-value "
            f"{self.p_values[worst]:.2g}, of the {worst})"
        )
