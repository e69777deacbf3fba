"""Predicted spectra and CV of webs against simulated fibres, and against themselves.

Claims, for the basic and the smooth model: the errors of `web_spectrum` cover the
distance to truncations that are larger by far; Ŝ lies within 4 standard errors of
periodograms of fibres that are long against what they need to forget, over whole
periods of the belt; CV² of `predict_web` lies within 4 standard errors of the mean
overlap of two zones along a fibre less that of independent fibres.
"""

from __future__ import annotations

import argparse
import math
import time

import numpy as np
from reporting import Report

import fpsolve as fp
from fpsolve.paths import EquilibriumLaw
from fpsolve.spectral.resolvent import smooth_solutions
from fpsolve.spectral.resolvent.basis import Basis
from fpsolve.spectral.resolvent.fibre import Fibre, fibre_of
from fpsolve.spectral.resolvent.ladder import Ladder
from fpsolve.spectral.resolvent.round_ladder import RoundLadder
from fpsolve.spectral.resolvent.smooth_ladder import SmoothLadder
from fpsolve.spectral.resolvent.waves import along_long_waves

ROUND, QUARTIC = fp.QuadraticPotential(), fp.PowerPotential(4)
NARROW = fp.QuadraticPotential(1.0, 0.6)
# Noise, belt speed, potential, relaxation length or 0 for the basic model.
QUICK = [(2.0, 0.2, ROUND, 0.0), (3.0, 0.3, ROUND, 0.1)]
FULL = [
    (1.0, 0.1, ROUND, 0.0), (1.0, 0.3, ROUND, 0.0), (2.0, 0.2, NARROW, 0.0),
    (10.0, 0.3, ROUND, 0.0), (1.0, 0.1, QUARTIC, 0.0), (2.0, 0.2, QUARTIC, 0.0),
    (1.0, 0.1, ROUND, 0.1), (2.0, 0.2, NARROW, 0.1), (3.0, 0.3, ROUND, 0.5),
]  # fmt: skip
Case = tuple[float, float, fp.Potential, float]
# Degree and harmonics of what errors of the basic model are compared with.
LARGE, LARGE_ROUND = Basis(40, 20), Basis(34, 14)
# Steps by which the large truncation of a smooth fibre is larger than the smallest.
STEPS = 3
# Of spectra beside periodograms, whose standard errors are several percent.
TOLERANCE = 5e-3
# Arclength between two points of a path; fine against |k| <= 3. The sum over lags has
# its kink at zero and exceeds the integral by 0.22 (DS/side)² of it, 0.3 % at most.
DS = 1 / 16
# Periodograms lack about the share of a relaxation in the length: of fibres that need
# more than a twentieth of it to forget, about 1 + A², there are none.
FORGOTTEN = 20.0
# Until the fibre has forgotten where it began, in units of 1 + A².
BEGIN = 12.0
# Zones overlap up to a lag of (side + 10 σ)/v; no more is left of the law beyond.
REACH = 10.0


def belt(
    noise: float, speed: float, potential: fp.Potential, length: float
) -> fp.LayDownModel | fp.SmoothLayDownModel:
    curve = fp.MovingBelt(speed)
    if length:
        return fp.SmoothLayDownModel(potential, length, noise, curve)
    return fp.LayDownModel(potential, noise, curve)


def told(case: Case) -> str:
    noise, speed, potential, length = case
    return f"{potential.formula}, A = {noise:g}, v = {speed:g}, R = {length:g}"


def exact_of(fibre: Fibre, k1: float, k2: float) -> float:
    """Ŝ as a truncation knows it that is larger by far."""
    if isinstance(fibre, SmoothLadder):
        grown = fibre.generator(fibre.first.grown(STEPS))
        return float(smooth_solutions.along_long_waves(grown, k1, [k2])[0])
    assert isinstance(fibre, Ladder)
    large = LARGE_ROUND if isinstance(fibre, RoundLadder) else LARGE
    return float(along_long_waves(fibre.generator(large), k1, [k2])[0])


def check_coverage(report: Report, cases: list[Case]) -> None:
    """Distance to a larger truncation in units of the errors."""
    rng = np.random.default_rng(1)
    for case in cases:
        fibre, shares = fibre_of(belt(*case)), []
        # The largest truncation of a smooth fibre holds no shorter waves.
        for size in (0.2, 1.0, 2.0) if case[3] else (0.2, 1.0, 2.0, 2.8):
            beta = rng.uniform(0, 0.5 * math.pi)
            parts = size * math.cos(beta), size * math.sin(beta)
            k1, k2 = (
                part / sigma for part, sigma in zip(parts, fibre.scales, strict=True)
            )
            exact = exact_of(fibre, k1, k2)
            for tolerance in (3e-2, 1e-2) if case[3] else (1e-2, 1e-3):
                found = fibre.spectrum(np.array([k1]), np.array([k2]), tolerance)
                shares.append(abs(float(found[0][0]) - exact) / float(found[1][0]))
        name = f"{told(case)}: distance over error of Ŝ"
        report.check(name, max(shares), "<", 1.0)


def simulated(
    model: fp.LayDownModel | fp.SmoothLayDownModel, n_paths: int, n_steps: int
) -> np.ndarray:
    """η of paths that have forgotten their start; shape (steps, paths, 2)."""
    begin = DS * round(BEGIN * (1 + model.noise**2) / DS)
    s = begin + DS * np.arange(n_steps)
    initial = EquilibriumLaw(model.potential)
    paths = fp.sample_paths(
        model, n_paths, float(s[-1]), DS, seed=17, initial=initial, save_at=s
    )
    eta = np.array(paths.xi)
    eta[..., 0] -= model.curve.speed * (s - begin)[:, None]
    return eta


def check_periodograms(report: Report, case: Case, eta: np.ndarray) -> None:
    """Ŝ over a length S against |∫ e^{ik·η} ds|²/S, k1 v S a multiple of 2π."""
    model, length = belt(*case), DS * len(eta)
    unit = 2 * math.pi / (model.curve.speed * length)
    rows, scores = [], []
    for k1, k2 in ((0.5, 0.0), (0.5, 1.0), (1.0, 2.0), (2.0, 0.5), (1.5, 2.5)):
        whole = unit * round(k1 / unit)
        wave = np.exp(1j * (whole * eta[..., 0] + k2 * eta[..., 1]))
        powers = np.abs(DS * wave.sum(axis=0)) ** 2 / length
        error = float(powers.std(ddof=1)) / math.sqrt(powers.size)
        spectrum = fp.web_spectrum(model, whole, k2, tolerance=TOLERANCE)
        scores.append(abs(float(powers.mean() - spectrum)) / error)
        rows.append({"case": told(case), "k1": whole, "k2": k2,
                     "predicted": float(spectrum), "paths": float(powers.mean()),
                     "standard error": error})  # fmt: skip
    report.table(rows)
    report.check(f"{told(case)}: |z| of periodograms", max(scores), "<", 4.0)


def check_zones(report: Report, case: Case, eta: np.ndarray) -> None:
    """CV²/(v d) of three zones, without strips: d is small against σ."""
    spacing, rows, scores = 0.1, [], []
    model, sides = belt(*case), (0.5, 1.0, 3.0)
    began = time.process_time()
    prediction = fp.predict_web(model, spacing=spacing, zones=sides)
    seconds = time.process_time() - began
    for side, cv, error in zip(sides, prediction.cv, prediction.errors, strict=True):
        overlaps = mean_overlaps(eta, side, model.curve.speed)
        simulated_cv2 = float(overlaps.mean()) * model.curve.speed * spacing
        standard = float(overlaps.std(ddof=1)) / math.sqrt(overlaps.size)
        standard *= model.curve.speed * spacing
        scores.append(abs(simulated_cv2 - cv**2) / math.hypot(standard, 2 * cv * error))
        rows.append({"case": told(case), "side": side,
                     "predicted CV²": cv**2, "error": 2 * cv * error,
                     "paths": simulated_cv2, "standard error": standard,
                     "CPU seconds": seconds})  # fmt: skip
    report.table(rows)
    report.check(f"{told(case)}: |z| of CV²", max(scores), "<", 4.0)


def mean_overlaps(eta: np.ndarray, side: float, speed: float) -> np.ndarray:
    """∫ ds [K_x(η_s − η_0) − the same with the ξ_s of another path], of every path."""
    n_steps, n_paths, _ = eta.shape
    last = int((side + REACH) / speed / DS)
    begins = np.linspace(0, n_steps - last - 1, 12).astype(int)
    at = np.arange(n_paths)
    total = np.zeros(n_paths)
    for lag in range(last):
        pair = [
            np.prod(np.maximum(0.0, 1 - np.abs(eta[begins + lag][:, of] - eta[begins])
                               / side), axis=-1)
            for of in (at, np.roll(at, 1))
        ]  # fmt: skip
        weight = DS / side**2 * (1 if lag == 0 else 2)
        total += weight * (pair[0] - pair[1]).mean(axis=0)
    return total


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one model, fewer paths")
    parser.add_argument("--cases", type=int, nargs="+", help="some of the full ones")
    options = parser.parse_args()
    quick = options.quick
    report = Report("web_prediction", quick)
    cases = QUICK if quick else FULL
    if options.cases:
        cases = [FULL[number] for number in options.cases]
    check_coverage(report, cases)
    for case in cases:
        model = belt(*case)
        needed = int((3.0 + REACH) / model.curve.speed / DS)
        eta = simulated(model, 400 if quick else 2000, 2 * needed)
        if DS * len(eta) >= FORGOTTEN * (1 + model.noise**2):
            check_periodograms(report, case, eta)
        check_zones(report, case, eta)
    report.finish()


if __name__ == "__main__":
    main()
