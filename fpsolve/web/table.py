"""Ŝ over all wave vectors, from as few solutions as its shape asks for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.persistence import Persistence
from fpsolve.spectral.resolvent.fibre import Fibre, differentiable
from fpsolve.web.even import EvenNodes

__all__ = ["AXES", "Axis", "SpectrumTable"]

Axis = Literal["along", "across", "shortness", "direction"]
AXES: tuple[Axis, ...] = ("along", "across", "shortness", "direction")
# |k1| σ1 and |k2| σ2 up to which the table is a product of wave numbers.
END = 2.5
# Nodes to begin with; across they cost little where one factorisation serves all.
N_NODES: dict[Axis, int] = {"along": 9, "across": 17, "shortness": 9, "direction": 5}
# Graded no further than this share of an interval.
FINEST = 0.02
# Of the largest κ Ŝ a part that no zone notices.
SMALL = 1e-3


@dataclass(eq=False)
class Source:
    """Ŝ, or a derivative, and its error at wave vectors, each computed once.

    Attributes
    ----------
    ladder : Fibre
    tolerance : float
        Of Ŝ.
    gradients : bool
        Whether derivatives are computed beside Ŝ.
    column : int
        0 for Ŝ, then the derivatives in the order of `Generator.parameters`.
    """

    ladder: Fibre
    tolerance: float
    gradients: bool = False
    column: int = 0
    _known: dict[tuple[float, float], Array] = field(default_factory=dict)

    def __call__(self, k1: Array, k2: Array) -> tuple[Array, Array]:
        """Values and errors in the shape of `k1`."""
        pairs = list(zip(k1.ravel().tolist(), k2.ravel().tolist(), strict=True))
        new = sorted(set(pairs) - self._known.keys())
        if new:
            first, second = np.array(new).T
            compute = self.ladder.spectrum
            if self.gradients:
                compute = differentiable(self.ladder).gradient
            found = compute(first, second, self.tolerance)
            numbers = np.stack(found, axis=1).reshape(len(new), 2, -1)
            self._known.update(zip(new, numbers, strict=True))
        values = np.array([self._known[pair][:, self.column] for pair in pairs])
        return values[:, 0].reshape(k1.shape), values[:, 1].reshape(k1.shape)


@dataclass(frozen=True, eq=False)
class SpectrumTable:
    """Ŝ between nodes: inside a rectangle over (k1, k2), outside over (1/κ, cos β).

    Outside, k = κ (cos β/σ1, sin β/σ2), and κ Ŝ is an even function of 1/κ down to 0,
    where it is the law of the angle. Both are even in their other variable, too.

    Attributes
    ----------
    source : Source
    nodes : dict of EvenNodes
        By axis.
    """

    source: Source
    nodes: dict[Axis, EvenNodes]

    @classmethod
    def of(
        cls, ladder: Fibre, tolerance: float, gradients: bool = False
    ) -> SpectrumTable:
        """With few nodes, where the model has its scales."""
        model, (sigma1, sigma2) = ladder.model, ladder.scales
        # Of the angle: A²/2, or less where the fibre is smooth.
        wide, diffusivity = max(sigma1, sigma2), 1.0 / Persistence.of(model).length
        # Of about the size of the gap: A²/2 at low noise, 1/(σ² A²) at high noise.
        rate = diffusivity / (1.0 + 2.0 * (diffusivity * wide) ** 2)
        ridge = rate * wide / max(abs(model.curve.speed), 1e-300)
        scales: dict[Axis, tuple[float, float]] = {
            "along": (END / sigma1, 2.0 * ridge / sigma1),
            "across": (END / sigma2, END / sigma2),
            "shortness": (1.0 / END, 1.0 / (diffusivity * wide)),
            "direction": (1.0, END * ridge),
        }
        dear = {} if ladder.shared >= END else {"across": N_NODES["along"]}
        nodes = {
            axis: EvenNodes(
                end,
                float(np.clip(scale, FINEST * end, end)),
                dear.get(axis, N_NODES[axis]),
            )
            for axis, (end, scale) in scales.items()
        }
        return cls(Source(ladder, tolerance, gradients), nodes)

    def finer(self, axis: Axis) -> SpectrumTable:
        """With twice as many nodes along one axis."""
        return replace(self, nodes=self.nodes | {axis: self.nodes[axis].finer()})

    def derivative(self, parameter: int) -> SpectrumTable:
        """The same of a derivative of Ŝ, between the same nodes.

        A fixed set of nodes makes the interpolant of the derivative the derivative of
        the interpolant.
        """
        return replace(self, source=replace(self.source, column=1 + parameter))

    @property
    def ends(self) -> tuple[float, float]:
        """Of the rectangle."""
        return self.nodes["along"].end, self.nodes["across"].end

    @cached_property
    def inside(self) -> tuple[Array, Array]:
        """Ŝ and errors at the nodes (k1, k2)."""
        k1, k2 = np.meshgrid(
            self.nodes["along"].points, self.nodes["across"].points, indexing="ij"
        )
        return self.source(k1, k2)

    @cached_property
    def outside(self) -> tuple[Array, Array]:
        """κ Ŝ and errors at the nodes (1/κ, cos β), the last ones at κ = ∞."""
        shortness = self.nodes["shortness"].points[:-1, None]
        cosine = self.nodes["direction"].points
        sigma1, sigma2 = self.source.ladder.scales
        sine = np.sqrt(1.0 - cosine**2)
        # In this order, so that a node of a coarser table is the same numbers.
        values, errors = self.source(
            cosine / sigma1 / shortness, sine / sigma2 / shortness
        )
        law = self._law(cosine / sigma1, sine / sigma2)
        # What two truncations of the law differ by is part of the error of every node.
        last = errors[-1:] / shortness[-1]
        values = np.concatenate([values / shortness, law[None]])
        return values, np.concatenate([errors / shortness, last])

    @property
    def share(self) -> float:
        """Of Ŝ the largest error outside, relative to κ Ŝ or to what is small of it."""
        values, errors = self.outside
        return float(np.max(errors / np.maximum(values, SMALL * values.max())))

    def _law(self, k1: Array, k2: Array) -> Array:
        ladder = self.source.ladder
        pairs = list(zip(k1.tolist(), k2.tolist(), strict=True))
        if not self.source.column:
            return np.array([ladder.limit(pair) for pair in pairs])
        of_limit = differentiable(ladder).limit_changes
        changes = np.array([of_limit(pair) for pair in pairs])
        return np.asarray(changes[:, self.source.column - 1])

    def __call__(self, k1: Array, k2: Array, fewer: Axis | None = None) -> Array:
        """Ŝ at wave vectors k1, k2 >= 0, of one shape and none of them zero."""
        return self._between(self.inside[0], self.outside[0], k1, k2, fewer)

    def bound(self, k1: Array, k2: Array) -> Array:
        """What errors of the nodes make of it at most."""
        return self._between(self.inside[1], self.outside[1], k1, k2, None, np.abs)

    def _between(
        self,
        inside: Array,
        outside: Array,
        k1: Array,
        k2: Array,
        fewer: Axis | None,
        weights: Callable[[Array], Array] = np.asarray,
    ) -> Array:
        sigma1, sigma2 = self.source.ladder.scales
        within = (k1 <= self.ends[0]) & (k2 <= self.ends[1])
        result = np.empty(k1.shape)

        def at(axis: Axis, where: Array) -> Array:
            return weights(self.nodes[axis].at(where, fewer == axis))

        along, across = at("along", k1[within]), at("across", k2[within])
        result[within] = ((along @ inside) * across).sum(axis=1)
        first, second = k1[~within] * sigma1, k2[~within] * sigma2
        size = np.hypot(first, second)
        shortness, direction = (
            at("shortness", 1.0 / size),
            at("direction", first / size),
        )
        result[~within] = ((shortness @ outside) * direction).sum(axis=1) / size
        return result
