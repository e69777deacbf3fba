"""Formulas as MathML, which browsers draw themselves."""

from __future__ import annotations

import html
from xml.etree import ElementTree

from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.potentials.potential import Potential
from fpsolve.pages.blocks import Equation

__all__ = [
    "curve_equations",
    "energy_equations",
    "fokker_planck",
    "mathml",
    "model_equations",
    "potential_equation",
    "smooth_fokker_planck",
]


def energy_equations() -> list[Equation]:
    """Return the averaged equation (15) of the energy process, and its variance."""
    return [
        mathml(
            r"dG = -\frac{A^2}{2}\,G\,ds + \sigma(G)\,dW",
            "dG = -(A²/2) G ds + σ(G) dW",
        ),
        mathml(r"\sigma^2(G) = A^2\,\frac{J(G)}{S(G)}", "σ²(G) = A² J(G)/S(G)"),
    ]


def mathml(latex: str, plain: str) -> Equation:
    """Return a formula as MathML, or without where LaTeX is beyond its reader.

    Parameters
    ----------
    latex : str
        Without dollar signs.
    plain : str
        The same in Unicode: the alternative text.
    """
    from latex2mathml.converter import convert_to_element

    try:
        element = convert_to_element(latex, display="block")
    # It trips over what it does not know in many ways, each with its own exception.
    except Exception:
        return Equation(None, plain)
    for node in element.iter():
        # A link is not part of a formula, and a command not known stays as it is.
        if "href" in node.attrib or (node.text or "").startswith("\\"):
            return Equation(None, plain)
        # Symbols come as entities. Unescaped here and escaped again below, so is
        # whatever else a user's formula holds.
        node.text = html.unescape(node.text) if node.text else node.text
    element.set("alttext", plain)
    return Equation(ElementTree.tostring(element, encoding="unicode"), plain)


def model_equations(model: FibreModel) -> list[Equation]:
    """Return the Fokker-Planck equation of a model, its potential and its curve."""
    plain, _, _ = model.equation.partition(", B = ")
    return [
        mathml(model.latex, plain),
        potential_equation(model.potential),
        *curve_equations(model.curve),
    ]


def curve_equations(curve: Curve) -> list[Equation]:
    """Return γ(s) = …; nothing for a belt, which its speed says all about."""
    if curve.autonomous:
        return []
    return [mathml(rf"\gamma(s) = {curve.latex}", f"γ(s) = {curve.formula}")]


def potential_equation(potential: Potential) -> Equation:
    """Return B(ξ) = … of a potential."""
    return mathml(rf"B(\xi) = {potential.latex}", f"B(ξ) = {potential.formula}")


def fokker_planck() -> Equation:
    """Return equation (9), of a belt at rest, for studies over the noise A."""
    return mathml(
        r"\partial_s p + \tau(\alpha)\cdot\nabla_\xi p"
        r" - \partial_\alpha(\nabla B\cdot\tau^\perp p)"
        r" = \frac{A^2}{2}\,\partial_{\alpha\alpha} p",
        "∂ₛp + τ(α)·∇p - ∂_α(∇B·τ⊥ p) = (A²/2) ∂_αα p",
    )


def smooth_fokker_planck() -> Equation:
    """Return equation (23), of a belt at rest, for studies over the noise A."""
    return mathml(
        r"\partial_s p + \tau\cdot\nabla_\xi p + \kappa\,\partial_\alpha p"
        r" - \frac1R\,\partial_\kappa((\kappa + \nabla B\cdot\tau^\perp) p)"
        r" = \frac{A^2}{2R^2}\,\partial_{\kappa\kappa} p",
        "∂ₛp + τ·∇p + κ ∂_α p - ∂_κ((κ + ∇B·τ⊥) p)/R = (A²/2R²) ∂_κκ p",
    )
