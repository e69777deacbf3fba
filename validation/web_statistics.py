"""Standard errors of what is measured on a web cover, for webs with known answers.

Many webs of white noise, of clouds with a Gaussian covariance, of straight fibres and
of planted strips; of every measure how often its 95 % interval holds the exact value,
and how its standard error compares with the scatter over webs.
"""

from __future__ import annotations

import argparse
import importlib
import math
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from reporting import Report

from fpsolve.web.statistics.cloudiness import cloudiness
from fpsolve.web.statistics.estimate import Estimate
from fpsolve.web.statistics.formation import formation_number
from fpsolve.web.statistics.orientation import machine_cross_ratio, orientation_rose
from fpsolve.web.statistics.spectrum import power_spectrum
from fpsolve.web.statistics.strips import strips
from fpsolve.web.statistics.zones import coefficient_of_variation, mean_density

# The webs with known answers of the tests.
sys.path.append(str(Path(__file__).parents[1] / "tests" / "support"))
ORACLES: Any = importlib.import_module("straight_fibres")

SHAPE = (96, 192)
CLOUD, STICK, SPREAD = 2.0, 6.0, 0.1
Case = tuple[str, Callable[[Any], Any], Callable[[Any], Estimate], float]


def noise(generator: Any) -> Any:
    """White noise."""
    return 1 + SPREAD * generator.standard_normal(SHAPE)


def clouds(generator: Any) -> Any:
    """Half of a periodic field, so that its edges do not fit."""
    field = ORACLES.correlated_field(generator, (192, 384), CLOUD)
    return 1 + SPREAD * field[: SHAPE[0], : SHAPE[1]]


def sticks(generator: Any) -> Any:
    """Straight fibres of finite length."""
    return ORACLES.web_of_sticks(generator, SHAPE, STICK, 1.0)


def lines(generator: Any) -> Any:
    """Independent tiles of infinite straight fibres."""
    return ORACLES.tiles_of_lines(generator, (8, 12), 8, 2.0)


def striped(generator: Any) -> Any:
    """A wave of period 7.3 across the web in noise."""
    place = np.arange(SHAPE[0]) + 0.5
    wave = 0.05 * np.cos(2 * np.pi * place / 7.3)
    return 1 + wave[:, None] + 0.5 * generator.uniform(-1, 1, SHAPE)


def tilted(generator: Any) -> tuple[Any, Any]:
    """One fibre per pixel with the density (1 + cos 2θ)/π of its angle."""
    # cos² by rejection, three times as many as are left.
    n = math.prod(SHAPE)
    angle = generator.uniform(0, np.pi, 4 * n)
    angle = angle[generator.uniform(0, 1, 4 * n) < np.cos(angle) ** 2][:n]
    along = np.stack((np.cos(angle), np.sin(angle)), axis=-1).reshape(*SHAPE, 2)
    return generator.gamma(2.0, size=SHAPE), along[..., :, None] * along[..., None, :]


def cases() -> Iterator[Case]:
    """Measure, webs, estimate of one web, exact value."""
    for zone in (1, 4, 12):
        yield f"CV({zone}), noise", noise, variation(zone), SPREAD / zone
        yield f"CV({zone}), clouds", clouds, variation(zone), cloud_variation(zone)
    for zone in (1, 2, 6):
        truth = math.sqrt(ORACLES.stick_variance(zone, STICK, 1.0))
        yield f"CV({zone}), sticks", sticks, variation(zone), truth
    yield "mean, sticks", sticks, lambda web: mean_density(web, 1.0), 1.0
    for zone in (1, 4, 8):
        yield (
            f"formation({zone}), lines", lines,
            lambda web, zone=zone: formation_number(web, 1.0, zone, block=8.0), 1.0,
        )  # fmt: skip
    for band in ((6.0, 12.0), (12.0, 24.0)):
        yield (
            f"cloudiness{band}, clouds", clouds,
            lambda web, band=band: cloudiness(web, 1.0, band), cloud_power(*band),
        )  # fmt: skip
    yield "MD/CD, tilted", tilted, lambda web: machine_cross_ratio(web[0], 1, web[1]), 3
    # The bin around the machine direction: cos² over 5 degrees.
    half = np.pi / 72
    rose = (1 + np.sin(2 * half) / (2 * half)) / np.pi
    yield (
        "rose(0), tilted", tilted,
        lambda web: orientation_rose(web[0], 1.0, web[1])[0], rose,
    )  # fmt: skip
    yield "strips, amplitude", striped, lambda web: strips(web, 1.0).amplitude, 0.05
    yield "strips, period", striped, lambda web: strips(web, 1.0).period, 7.3
    yield "strips, share", striped, lambda web: strips(web, 1.0).share, strip_share()
    yield "spectrum ring 5, noise", noise, ring, SPREAD**2


def strip_share() -> float:
    """Power of the planted wave over it and the noise of a profile of 192 columns."""
    place = np.arange(SHAPE[0]) + 0.5
    wave = float(np.var(0.05 * np.cos(2 * np.pi * place / 7.3)))
    return wave / (wave + 0.25 / 3 / SHAPE[1] * (1 - 1 / SHAPE[0]))


def variation(zone: float) -> Callable[[Any], Estimate]:
    """CV at a zone."""
    return lambda web: coefficient_of_variation(web, 1.0, zone)


def ring(web: Any) -> Estimate:
    """The spectrum over the sixth ring of wave vectors."""
    return power_spectrum(web, 1.0).radial[5]


def cloud_variation(zone: int) -> float:
    """CV of zones of the periodic field, exactly."""
    shape = (192, 384)
    power = ORACLES.gaussian_power(shape, CLOUD)
    waves = [np.fft.fft(np.arange(n) < zone) / zone for n in shape]
    smoothing = np.abs(waves[0][:, None] * waves[1]) ** 2
    return SPREAD * math.sqrt(float(np.sum(power * smoothing)))


def cloud_power(shortest: float, longest: float) -> float:
    """Power of clouds in a band of wavelengths on the endless plane."""
    low, high = (
        math.exp(-((2 * math.pi * CLOUD / wave) ** 2) / 2)
        for wave in (longest, shortest)
    )
    return SPREAD**2 * (low - high)


def coverage(case: Case, n_webs: int, generator: Any) -> dict[str, Any]:
    """How often the interval holds the exact value, and error against scatter."""
    name, web_of, measured, truth = case
    found = [measured(web_of(generator)) for _ in range(n_webs)]
    ends = [one.interval() for one in found]
    inside = np.mean([low <= truth <= high for low, high in ends])
    values, errors = np.array(found), np.array([one.standard_error for one in found])
    scatter = values.std(ddof=1)
    return {
        "measure": name, "exact": truth, "mean": values.mean(),
        "blocks": np.mean([one.n_blocks for one in found]),
        "bias / error": (values.mean() - truth) / errors.mean(),
        "error / scatter": errors.mean() / scatter, "covered": inside,
    }  # fmt: skip


def false_strips(n_webs: int, generator: Any) -> float:
    """Share of webs of noise whose strongest wave has a p value below 0.05."""
    webs = (1 + 0.5 * generator.uniform(-1, 1, (40, 80)) for _ in range(n_webs))
    return float(np.mean([strips(web, 1.0).p_value < 0.05 for web in webs]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    report, n_webs = Report("web_statistics", quick), 40 if quick else 400
    generator = np.random.default_rng(2026)
    rows = [coverage(case, n_webs, generator) for case in cases()]
    report.table(rows)
    # Four standard errors of a count of webs below 95 %, and two points for what is
    # not exact: blocks that are nearly independent, laws of squares that are skew.
    allowed = 0.95 - 0.02 - 4 * math.sqrt(0.95 * 0.05 / n_webs)
    for row in rows:
        name = row["measure"]
        report.check(f"{name}: covered by 95 %", row["covered"], ">", allowed)
        report.check(f"{name}: |bias| / error", abs(row["bias / error"]), "<", 0.6)
    n_false = 20 * n_webs
    bound = 0.05 + 4 * math.sqrt(0.05 * 0.95 / n_false)
    share = false_strips(n_false, generator)
    report.check("noise called strips at p < 0.05", share, "<", bound)
    report.finish()


if __name__ == "__main__":
    main()
