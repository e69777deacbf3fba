"""Calls that work, with one or two arguments replaced by what nobody prepared for."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

import fpsolve as fp
from fpsolve import diagnostics, initial, interop, studies

from .families import family

NAN, INF = float("nan"), float("inf")
JUNK: tuple[Any, ...] = (
    None, True, False, 0, 1, -1, 2, 3, 2**70, -(2**70), 0.0, -0.0, 0.5, 1e-300, 5e-324,
    1e-12, 1e300, -1e300, NAN, INF, -INF, 1j, "", "x", "1.0", b"1", (), [], {}, set(),
    (1.0,), (1.0, 2.0), [1.0, 2.0], (NAN, 0.0), (1.0, 2.0, 3.0), [[1.0, 2.0], [3.0]],
    np.float32(0.5), np.float64(0.25), np.int8(1), np.uint64(2**63), np.bool_(True),
    np.array(0.5), np.array([]), np.array([0.5]), np.array([[0.5]]), np.zeros((0, 3)),
    np.array(["a"]), np.array([None]), np.array(1 + 2j), np.datetime64("2020-01-01"),
    np.ma.masked, np.ma.array([0.5, 0.5], mask=[True, False]), np.longdouble("0.5"),
    Decimal("0.5"), Fraction(1, 2), range(2), iter([0.5]), object(), lambda *_: NAN,
    lambda *a: a[0], print, fp.QuadraticPotential, fp.QuadraticPotential(),
    fp.FreePotential(), fp.FixedBelt(), Path("x"), slice(None), Ellipsis,
)  # fmt: skip


class Answers:
    """An object that says yes to everything."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return Answers()

    def __call__(self, *_: Any, **__: Any) -> Any:
        return Answers()


def model() -> Any:
    return fp.LayDownModel(fp.QuadraticPotential(), 1.0)


def grid() -> Any:
    return fp.PhaseSpaceGrid(5.0, (10, 10, 8))


def p0() -> Any:
    return initial.gaussian(grid(), (0.2, 0.1), 1.0)


def saved(path, engine):
    """Save a solution."""
    return solution().save(path, engine)


def solution() -> Any:
    return fp.solve(fp.drift_kick(model(), grid()), p0(), (0.0, 0.5), 0.25)


def energy() -> Any:
    return fp.EnergyProcess(fp.QuadraticPotential(), 0.5)


def limit() -> Any:
    return fp.HydrodynamicLimit(fp.LayDownModel(fp.QuadraticPotential(), 2.0))


def plane() -> Any:
    return fp.PlaneGrid(6.0, (12, 12))


def some_paths() -> Any:
    return fp.sample_paths(model(), 5, 1.0, 0.25, seed=1, save_at=(0.5, 1.0))


def curve_of(*_: Any) -> Any:
    return np.linspace(0.0, 1.0, 5)


# Name: the function and arguments with which it works; objects are made anew.
CALLS: dict[str, tuple[Callable[..., Any], Callable[[], dict[str, Any]]]] = {
    "QuadraticPotential": (fp.QuadraticPotential, lambda: {
        "sigma1": 1.0, "sigma2": 1.0}),
    "LinearPotential": (fp.LinearPotential, lambda: {"slope": 1.0}),
    "PowerPotential": (fp.PowerPotential, lambda: {"exponent": 3.0, "scale": 1.0}),
    "CallablePotential": (fp.CallablePotential, lambda: {
        "value": lambda x, y: x**2 + y**2, "gradient": lambda x, y: (2 * x, 2 * y)}),
    "IsotropicPotential": (fp.IsotropicPotential, lambda: {
        "value": lambda r: r**2, "derivative": lambda r: 2 * r}),
    "value": (fp.QuadraticPotential().value, lambda: {"xi1": 0.5, "xi2": 0.25}),
    "gradient": (fp.LinearPotential().gradient, lambda: {"xi1": 0.5, "xi2": 0.25}),
    "MovingBelt": (fp.MovingBelt, lambda: {"speed": 0.1}),
    "RotatingNozzle": (fp.RotatingNozzle, lambda: {
        "speed": 0.1, "radius": 0.5, "angular_speed": 1.0, "phase": 0.0}),
    "OscillatingNozzle": (fp.OscillatingNozzle, lambda: {
        "speed": 0.1, "amplitude": 0.5, "angular_speed": 1.0, "phase": 0.0}),
    "EllipticNozzle": (fp.EllipticNozzle, lambda: {
        "speed": 0.1, "radius1": 0.5, "radius2": 0.2, "angular_speed": 1.0}),
    "TabulatedCurve": (fp.TabulatedCurve, lambda: {
        "s": curve_of(), "gamma1": -0.1 * curve_of(), "gamma2": curve_of()}),
    "position": (fp.RotatingNozzle(0.1, 0.5, 1.0).position, lambda: {"s": 0.5}),
    "displacement": (fp.MovingBelt(0.1).displacement, lambda: {"s0": 0.0, "s1": 1.0}),
    "LayDownModel": (fp.LayDownModel, lambda: {
        "potential": fp.QuadraticPotential(), "noise": 1.0, "curve": fp.FixedBelt()}),
    "drift": (model().drift, lambda: {"xi1": 0.5, "xi2": 0.5, "alpha": 0.5, "s": 0.0}),
    "equilibrium": (model().equilibrium, lambda: {"xi1": 0.5, "xi2": 0.25}),
    "PhaseSpaceGrid": (fp.PhaseSpaceGrid, lambda: {
        "half_width": 5.0, "shape": (8, 8, 8)}),
    "PlaneGrid": (fp.PlaneGrid, lambda: {"half_width": 5.0, "shape": (8, 8)}),
    "Process": (fp.Process, lambda: {
        "sigma1": 0.01, "sigma2": 0.01, "noise": 10.0, "speed_ratio": 0.1,
        "spinning_speed": 50.0}),
    "gaussian": (initial.gaussian, lambda: {
        "grid": grid(), "mean": (0.0, 0.0), "variance": 1.0, "angle": 0.5,
        "concentration": 1.0}),
    "initial.equilibrium": (initial.equilibrium, lambda: {
        "grid": grid(), "potential": fp.QuadraticPotential()}),
    "from_function": (initial.from_function, lambda: {
        "grid": grid(), "f": lambda x, y, a: np.exp(-(x**2) - y**2)}),
    "drift_kick": (fp.drift_kick, lambda: {
        "model": model(), "grid": grid(), "positive": False, "balanced": False,
        "interpolation_order": 8}),
    "semi_lagrangian": (fp.semi_lagrangian, lambda: {
        "model": model(), "grid": grid(), "form": "h", "splitting": "strang",
        "diffusion": "crank_nicolson", "interpolation_order": 4, "limited": False,
        "perturbation": 0.5, "adjusted": True, "compact": True}),
    "solve": (fp.solve, lambda: {
        "scheme": fp.drift_kick(model(), grid()), "p0": p0(), "s_span": (0.0, 0.5),
        "ds": 0.25, "save_at": (0.5,), "extrapolate": False, "progress": False,
        "mass_tolerance": 1e-10, "boundary_tolerance": 1.0, "negative_tolerance": 0.2,
        "reference": None, "record_every": 1, "memory_limit": None,
        "checkpoint": None}),
    "density": (solution().density, lambda: {"s": 0.5}),
    "marginal": (solution().marginal, lambda: {"which": "xi", "s": 0.5}),
    "entropy_rate": (solution().entropy_rate, lambda: {"window": (0.0, 0.5)}),
    "Solution.save": (solution().save, lambda: {"path": "a.nc", "engine": None}),
    "steady_state": (fp.steady_state, lambda: {
        "model": fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1)),
        "grid": grid(), "ds": 0.25, "tolerance": 1e-3, "extrapolate": False,
        "boundary_tolerance": 1.0}),
    "suggest_grid": (fp.suggest_grid, lambda: {"model": model(), "tolerance": 1e-2}),
    "suggest_step": (fp.suggest_step, lambda: {
        "model": model(), "grid": grid(), "tolerance": 1e-2}),
    "sample_paths": (fp.sample_paths, lambda: {
        "model": model(), "n_paths": 5, "s_end": 0.5, "ds": 0.25, "seed": 1,
        "rng": None,
        "initial": ((0.1, 0.2), 0.3), "save_at": (0.25, 0.5), "s_start": 0.0,
        "method": "splitting", "histogram": grid(), "keep": True, "client": None,
        "progress": False, "memory_limit": None}),
    "expectation": (some_paths().expectation, lambda: {"f": lambda x, y, a: x}),
    "time_averages": (some_paths().time_averages, lambda: {"f": lambda x, y, a: x}),
    "histogram": (some_paths().histogram, lambda: {"grid": grid(), "s": 0.5}),
    "replay": (some_paths().replay, lambda: {"k": 1, "every": 1}),
    "continued": (some_paths().continued, lambda: {
        "s_end": 2.0, "save_at": (1.5, 2.0)}),
    "GaussianLaw": (fp.paths.GaussianLaw, lambda: {
        "mean": (0.0, 0.0), "variance": 1.0, "angle": 0.5, "concentration": 1.0}),
    "PointLaw": (fp.paths.PointLaw, lambda: {"xi": (0.0, 0.0), "alpha": 0.5}),
    "DensityLaw": (fp.paths.DensityLaw, lambda: {"grid": grid(), "p": p0()}),
    "EquilibriumLaw": (fp.paths.EquilibriumLaw, lambda: {
        "potential": fp.QuadraticPotential()}),
    "spectrum": (fp.spectrum, lambda: {
        "model": model(), "n_eigenvalues": 2, "tolerance": 1e-2, "memory_limit": None}),
    "spectral_gap": (fp.spectral_gap, lambda: {"model": model(), "tolerance": 1e-3}),
    "spectral_solve": (fp.spectral_solve, lambda: {
        "model": model(), "p0": fp.paths.GaussianLaw((0.1, 0.0), 0.8), "s": 0.25,
        "tolerance": 1e-2, "memory_limit": None}),
    "spectral_steady_state": (fp.spectral_steady_state, lambda: {
        "model": model(), "tolerance": 1e-2, "memory_limit": 2**30}),
    "EnergyProcess": (fp.EnergyProcess, lambda: {
        "potential": fp.QuadraticPotential(), "noise": 0.5}),
    "period": (energy().period, lambda: {"g": 0.3}),
    "orbit": (energy().orbit, lambda: {"g": 0.3, "n_points": 21}),
    "stationary_density": (energy().stationary_density, lambda: {
        "g": 0.3, "signed": False}),
    "turning_points": (energy().turning_points, lambda: {"g": 0.3}),
    "eigenvalues": (energy().eigenvalues, lambda: {"n": 2, "family": "odd"}),
    "passage": (energy().passage, lambda: {"target": 0.1}),
    "energy.solve": (energy().solve, lambda: {
        "start": 0.3, "s_span": (0.0, 1.0), "ds": 0.25, "grid": energy().grid(12),
        "save_at": (1.0,), "method": "sdirk2", "extrapolate": False,
        "record_every": 1}),
    "energy.sample": (energy().sample, lambda: {
        "n_paths": 5, "s_end": 1.0, "ds": 0.25, "seed": 1, "initial": 0.2,
        "save_at": (1.0,), "method": "sphere"}),
    "HydrodynamicLimit": (fp.HydrodynamicLimit, lambda: {"model": model()}),
    "limit.solve": (limit().solve, lambda: {
        "P0": lambda x, y: np.exp(-(x**2) - y**2), "s_span": (0.0, 1.0), "ds": 0.5,
        "grid": plane(), "method": "sdirk2", "save_at": (1.0,), "extrapolate": False,
        "record_every": 1, "boundary_tolerance": 1.0}),
    "limit.sample": (limit().sample, lambda: {
        "n_paths": 5, "s_end": 1.0, "ds": 0.25, "seed": 1, "initial": (0.1, 0.2),
        "save_at": (1.0,), "method": "heun"}),
    "limit.steady_state": (limit().steady_state, lambda: {
        "grid": plane(), "boundary_tolerance": 1.0}),
    "limit.spectrum": (limit().spectrum, lambda: {"grid": plane(), "n_eigenvalues": 3}),
    "reconstruct": (limit().reconstruct, lambda: {
        "P": np.ones((10, 10)), "grid": grid(), "order": 1}),
    "initial_layer": (limit().initial_layer, lambda: {"p0": p0(), "grid": grid()}),
    "OrnsteinUhlenbeckLimit": (fp.OrnsteinUhlenbeckLimit, lambda: {
        "model": model(), "mean": (0.0, 0.0), "variance": 1.0}),
    "OU.mean": (fp.OrnsteinUhlenbeckLimit(model()).mean, lambda: {"s": 0.5}),
    "OU.density": (fp.OrnsteinUhlenbeckLimit(model()).density, lambda: {
        "xi1": 0.1, "xi2": 0.2, "s": 0.5}),
    "OU.eigenvalues": (fp.OrnsteinUhlenbeckLimit(model()).eigenvalues, lambda: {
        "n": 3}),
    "relative_entropy": (diagnostics.relative_entropy, lambda: {
        "p": p0(), "grid": grid(), "reference": p0()}),
    "entropy_dissipation": (diagnostics.entropy_dissipation, lambda: {
        "p": p0(), "grid": grid(), "noise": 1.0, "reference": p0()}),
    "moments": (diagnostics.moments, lambda: {"p": p0(), "grid": grid()}),
    "l1_distance": (diagnostics.l1_distance, lambda: {
        "p": p0(), "q": p0(), "grid": grid()}),
    "diagnostics.marginal": (diagnostics.marginal, lambda: {
        "p": p0(), "grid": grid(), "which": "xi"}),
    "to_pde_field": (fp.to_pde_field, lambda: {
        "p": p0(), "grid": grid(), "label": "p"}),
    "from_pde_field": (fp.from_pde_field, lambda: {
        "field": fp.to_pde_field(p0(), grid())}),
    "FokkerPlanckPDE": (interop.FokkerPlanckPDE, lambda: {"model": model()}),
    "save": (saved, lambda: {"path": "b.nc", "engine": "h5netcdf"}),
    "load": (fp.load, lambda: {"path": "missing.nc"}),
    "compare": (fp.compare, lambda: {"a": solution(), "b": solution()}),
    "rerun": (fp.rerun, lambda: {"result": solution()}),
    "report": (fp.report, lambda: {
        "results": solution(), "path": "r.html", "title": "t"}),
    "resume": (fp.resume, lambda: {"directory": "missing"}),
    "Checkpoint": (fp.Checkpoint, lambda: {
        "directory": "c", "every": "1min", "notes": {}}),
    "studies.compare": (studies.compare, lambda: {
        "density": solution(), "paths": some_paths(), "s": 0.5, "false_alarm": 1e-3,
        "cells": 64}),
    "fitted_order": (studies.fitted_order, lambda: {
        "epsilon": (0.5, 0.2, 0.1), "error": (0.25, 0.04, 0.01), "error_floor": None}),
    "observed_orders": (studies.observed_orders, lambda: {
        "epsilon": (0.5, 0.2, 0.1), "error": (0.25, 0.04, 0.01)}),
    "sweep": (studies.sweep, lambda: {
        "function": dict, "cases": [{"a": 1.0}], "workers": 0, "directory": None}),
    "rate_versus_noise": (studies.rate_versus_noise, lambda: {
        "potential": fp.QuadraticPotential(), "noises": (2.0,), "parts": ("gap",),
        "quick": True, "workers": 0, "tolerance": 1e-3, "directory": None}),
    "asymptotic_variances": (studies.asymptotic_variances, lambda: {
        "model": model(), "functions": {"x": lambda x, y, a: x}, "tolerance": 1e-2}),
}  # fmt: skip
# Elementwise functions of coordinates: NaN in, NaN out.
ELEMENTWISE = {"value", "gradient", "position", "displacement", "drift", "equilibrium",
               "OU.density", "OU.mean"}  # fmt: skip


@family(160, 16)
def junk(rng: Any, notes: Any) -> None:
    """One or two arguments are replaced; what comes back must be finite numbers."""
    names = sorted(CALLS)
    name = names[int(rng.integers(len(names)))]
    function, make = CALLS[name]
    arguments = make()
    chosen = rng.choice(sorted(arguments), min(len(arguments), int(rng.integers(1, 3))),
                        replace=False)  # fmt: skip
    for key in map(str, chosen):
        place = int(rng.integers(len(JUNK) + 1))
        arguments[key] = Answers() if place == len(JUNK) else JUNK[place]
    told = ", ".join(f"{key}={arguments[key]!r}" for key in map(str, chosen))
    notes.say(f"{name}({told}, …)")
    result = function(**arguments)
    if name not in ELEMENTWISE:
        notes.holds("finite numbers", finite(result))


def finite(result: Any) -> bool:
    """Whether every float in a result is a number; infinite is one of Z only."""
    if isinstance(result, float | np.ndarray):
        array = np.asarray(result)
        return array.dtype.kind not in "fc" or not bool(np.isnan(array).any())
    if isinstance(result, tuple | list):
        return all(finite(one) for one in result)
    if isinstance(result, dict):
        return all(finite(one) for one in result.values())
    if isinstance(result, fp.Solution):
        return all(bool(np.isfinite(one).all()) for one in result.densities)
    if isinstance(result, fp.Paths):
        return bool(np.isfinite(result.end).all())
    return True
