"""Fibres of a model at the points of a measured one, as many as are wanted."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from fpsolve._support.arrays import Array
from fpsolve.model.curves.curve import Curve
from fpsolve.model.fibre import FibreModel
from fpsolve.model.laydown import LayDownModel
from fpsolve.model.potentials.quadratic import QuadraticPotential
from fpsolve.model.smooth import SmoothLayDownModel
from fpsolve.paths.ensemble import state_of
from fpsolve.paths.fibres.fibre_curve import FibreCurve
from fpsolve.paths.randomness import noise_key
from fpsolve.paths.samplers import integrator_of
from fpsolve.studies.identification.increments import Sample

__all__ = ["LONGEST_REACH", "N_FIBRES", "Surrogate", "model_of", "whole_periods"]

# Fibres side by side: what the kernel computes at a time.
N_FIBRES = 64
# Steps at most, in units of σ and of 1/A²: second order leaves a part of 1e-3.
LONGEST, LARGEST_TURN = 0.05, 0.1
# Steps between two points at least, so that chords are those of a curve: the basic
# model's turn at lag one is short by (1/4m²) of its variance, and Γ_κ of smooth fibres
# with two steps by 0.4 % of it (measured, ± 0.2 %).
FEWEST = 4
# Units of σ that a fibre runs before it counts, from p_S and from near parameters.
FIRST_RUN, NEXT_RUN = 30.0, 6.0
# Points of a sample in units of k_max.
LONGEST_REACH = 20
# Steps whose states are held at a time.
LEG = 1024


def model_of(parameters: Mapping[str, float], curve: Curve) -> FibreModel:
    """The model of these parameters; smooth if K is among them."""
    potential = QuadraticPotential(parameters["sigma1"], parameters["sigma2"])
    noise = parameters["noise"]
    if "curvature_noise" not in parameters:
        return LayDownModel(potential, noise, curve)
    return SmoothLayDownModel(
        potential, noise / parameters["curvature_noise"], noise, curve
    )


class Surrogate:
    """Draws fibres with fresh noise whenever it is asked.

    Every call goes on where the last one ended, scaled to the new σ, so that a fibre
    needs no long run before it is stationary.

    Parameters
    ----------
    fibre : FibreCurve
        Whose Δs, reference curve and scatter of the points are taken.
    seed : int

    Attributes
    ----------
    next_run : float
        Units of σ that a fibre runs after other parameters before it counts.
    """

    def __init__(self, fibre: FibreCurve, seed: int) -> None:
        self.fibre = fibre
        self.next_run = NEXT_RUN
        self.seeds = np.random.SeedSequence(seed)
        self.state: Array | None = None
        self.sigma = np.ones(2)
        self.s = float(fibre.s_start[0])

    def pieces(self, model: FibreModel) -> list[Sample]:
        """64 fibres as those that were measured, all of their lengths and phases."""
        found = []
        for n, start in zip(self.fibre.lengths, self.fibre.s_start, strict=True):
            self.s = float(start) - (self._run(model) + 1) * self.fibre.ds
            found.append(self.sample(model, int(n)))
        return found

    def sample(self, model: FibreModel, n: int) -> Sample:
        """64 fibres of n points, after the last ones."""
        (seed,) = self.seeds.spawn(1)
        rng = np.random.default_rng(seed)
        run = self._run(model)
        state = self._start(model, rng)
        xi = self._advance(model, state, n + run, rng)[run:]
        self.state = state
        s = self.s + self.fibre.ds * (run + 1 + np.arange(n))
        self.s += self.fibre.ds * (run + n)
        eta = xi + np.stack(model.curve.position(s), axis=-1)[:, None, :]
        if self.fibre.position_error:
            scatter = self.fibre.position_error * rng.standard_normal(xi.shape)
            xi, eta = xi + scatter, eta + scatter
        return Sample.of(xi, eta)

    def _run(self, model: FibreModel) -> int:
        """Points that do not count."""
        reach = FIRST_RUN if self.state is None else self.next_run
        return math.ceil(reach * max(_sigma(model)) / self.fibre.ds)

    def _start(self, model: Any, rng: np.random.Generator) -> Array:
        """The last state, scaled to the throwing ranges of the model."""
        sigma = np.array(_sigma(model))
        if self.state is None or len(self.state) != integrator_of(model).n_state:
            xi = sigma * rng.standard_normal((N_FIBRES, 2))
            start = [xi, rng.uniform(0.0, 2 * np.pi, N_FIBRES)]
            if isinstance(model, SmoothLayDownModel):
                spread = math.sqrt(model.curvature_variance)
                start.append(spread * rng.standard_normal(N_FIBRES))
            state = state_of(*start)
        else:
            state = self.state
            state[:2] *= (sigma / self.sigma)[:, None]
        self.sigma = sigma
        return state

    def _advance(
        self, model: FibreModel, state: Array, n: int, rng: np.random.Generator
    ) -> Array:
        """ξ of the state, and of n - 1 points after it; (n, 64, 2)."""
        between = _between(model, self.fibre.ds)
        key = noise_key(int(rng.integers(2**62)))
        made = integrator_of(model)
        h = self.fibre.ds / between
        integrator = made(model, "splitting", h, self.s, key)
        xi = np.empty((n, state.shape[1], 2))
        per_leg = max(1, LEG // between)
        for begin in range(0, n, per_leg):
            end = min(begin + per_leg, n)
            trace = np.empty(((end - begin) * between, *state.shape))
            integrator.advance(state, 0, begin * between, len(trace), trace)
            xi[begin:end] = trace[between - 1 :: between, :2].transpose(0, 2, 1)
        return xi


def _sigma(model: FibreModel) -> tuple[float, float]:
    potential: Any = model.potential
    return potential.sigma1, potential.sigma2


def _between(model: FibreModel, ds: float) -> int:
    """Steps between two points."""
    wanted = [ds / (LONGEST * min(_sigma(model)))]
    if isinstance(model, LayDownModel):
        wanted.append(model.noise**2 * ds / LARGEST_TURN)
    return max(FEWEST, math.ceil(max(wanted)))


def whole_periods(fibre: FibreCurve, n: int) -> int:
    """Points of whole periods of the nozzle, so that all its phases count the same."""
    period = getattr(fibre.curve, "period", math.inf)
    if not (math.isfinite(period) and period > 0):
        return n
    per_period = period / fibre.ds
    return round(math.ceil(n / per_period) * per_period)
