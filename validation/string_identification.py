"""String, identification, web: fibres laid in turbulent air, and the webs of them.

Three fibres of ten metres are spun and laid: from a nozzle at rest into quiet and into
louder air, and from one that goes around. Each is identified with the basic and the
smooth model. Written are figures 8 and 9 of all three, and how well fibres of the
models stand for the string's in a web.

That web has spinning positions which are uniform across the belt: CV² = d v ∫ L² dx dy/
(x⁴ v S) in zones of side x, with L the length that a fibre of length S leaves in a zone
at (x, y) (Campbell's theorem). The one fibre of the string is enough for it, and 64 of
the model say how far one fibre may be from their mean.

Claims: edges keep their length; with edges of 5 mm AIC prefers the smooth model, as an
elastic fibre does not bend at once; CV of a laid web is that of Campbell's theorem for
fibres of its model; in the louder air CV of the string's fibres is that of both models
to 15 %. p-values are printed, not claimed: a string is neither model.
"""

from __future__ import annotations

import argparse
import os
import time
from typing import Any, NamedTuple

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402
from reporting import Report, save_figure  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve import fibre, plotting  # noqa: E402
from fpsolve.studies.identification.surrogate import Surrogate  # noqa: E402

BELT, SPEED = 0.1, 1.0
# Of the beginning, which the curve is without; what hangs in the air at the end.
SKIPPED, HANGING = 0.5, 0.4
# Spinning positions of the web, its zones and window, in m.
SPACING, ZONES, WINDOW, PIXEL = 1e-3, (0.01, 0.03), 0.9, 2.5e-3
# Edges that resolve how the fibre bends; energy of louder air, and by how much a model,
# none of which the string is, may there be off in CV.
FINE, LOUD, OFF = 5e-3, 0.3, 0.15
# Zones are laid over a fibre at so many offsets along and across.
OFFSETS = 3
# Pieces of fibre that count in one zone, in a length of that; zones across, at most.
PIECES, MANY = 10, 1 << 20


class Case(NamedTuple):
    """A nozzle and the air below it."""

    name: str
    energy: float
    dissipation: float
    radius: float = 0.0
    angular_speed: float = 0.0


CASES = (
    Case("quiet", 0.05, 1.0),
    Case("louder", 0.3, 5.0),
    Case("going around", 0.3, 5.0, 0.05, 2.0),
)


def laid(case: Case, length: float, edge: float) -> tuple[fibre.LayDown, float]:
    """So much fibre on the belt, and the CPU seconds for it."""
    nozzle = fibre.Nozzle(
        (0, 0, 0.3), (0.1, 0.03, -1), SPEED, radii=(case.radius, case.radius),
        angular_speed=case.angular_speed,
    )  # fmt: skip
    string = fibre.String(
        0.2, 2e-4, 1000.0, 1e8, nozzle, fibre.Free(), n_edges=round(0.2 / edge)
    )
    t_end = (SKIPPED + length + HANGING - string.length) / SPEED
    began = time.process_time()
    found = fibre.lay_down(
        string, t_end, round(t_end / (0.4 * edge)), belt=fibre.Belt(BELT), seed=1,
        air=fibre.AirFlow((0, 0, -1.5), k=case.energy, dissipation=case.dissipation),
        turbulence=fibre.TurbulentForce(), estimate_error=False,
    )  # fmt: skip
    return found, time.process_time() - began


def campbell(eta: np.ndarray, ds: float, zone: float, slow: float) -> float:
    """CV of zones in a web of such fibres at uniform places across the belt.

    `slow` is the speed of the belt over that of the fibre.
    """
    # Pieces much shorter than a zone, of which each counts in one.
    parts = max(1, round(PIECES * ds / zone))
    share = (np.arange(parts) + 0.5) / parts
    steps = np.diff(eta, axis=0)[:, None]
    pieces = (eta[:-1, None] + share[:, None] * steps).reshape(-1, 2) / zone
    total = 0.0
    for number in range(OFFSETS**2):
        offset = np.array(divmod(number, OFFSETS)) / OFFSETS
        along, across = np.floor(pieces + offset).astype(np.int64).T
        _, counts = np.unique(along * MANY + across, return_counts=True)
        total += float(((ds / parts * counts) ** 2).sum()) / OFFSETS**2
    length = ds * (len(eta) - 1)
    return float(np.sqrt(SPACING * slow * total / length) / zone)


def of_model(found: fp.Identification, zone: float) -> tuple[float, float]:
    """Mean and standard deviation of the CV from one fibre of a model, of 64."""
    curve = found.data
    (sample,) = Surrogate(curve, 5).pieces(found.model)
    gamma = np.stack(curve.curve.position(curve.arclengths[0]), axis=-1)
    values = [
        campbell(sample.xi[:, number] + gamma, curve.ds, zone, curve.curve.speed)
        for number in range(sample.xi.shape[1])
    ]
    return float(np.mean(values)), float(np.std(values, ddof=1))


def web_of(found: fp.Identification) -> list[tuple[float, float]]:
    """CV of a web laid by a model in all zones, and standard errors."""
    web = fp.lay_web(
        found.model, width=WINDOW, length=WINDOW, pixel=PIXEL, spacing=SPACING,
        positions="random", seed=7,
    )  # fmt: skip
    cvs = [web.coefficient_of_variation(zone) for zone in ZONES]
    # It varies about the mean of the window, which with the Poisson number of its
    # fibres has CV² = d/W.
    of_window = np.sqrt(SPACING / WINDOW)
    return [(float(np.hypot(cv, of_window)), float(cv.standard_error)) for cv in cvs]


def identified(curve: fp.FibreCurve, model: str) -> tuple[fp.Identification, float]:
    """The parameters, and the CPU seconds for them."""
    began = time.process_time()
    found = fp.identify(curve, model=model)
    return found, time.process_time() - began


def parameters_of(found: fp.Identification, took: float) -> dict[str, Any]:
    """Parameters with errors, and which model is better."""
    row: dict[str, Any] = {"model": name_of(found)}
    for name in ("sigma1", "sigma2", "noise", "curvature_noise"):
        value, error = found.parameters.get(name), found.standard_errors.get(name)
        row[name] = "-" if value is None else f"{value:.4g} ± {error:.1g}"
    return row | {"AIC": f"{found.aic:.0f}", "CPU s": took}


def fit_of(found: fp.Identification) -> dict[str, Any]:
    """p-values; by how much Γ of the model is off, and how much of it within 95 %."""
    row: dict[str, Any] = {"model": name_of(found)} | found.p_values
    for name, short in (("angle", "Γα"), ("curvature", "Γκ")):
        data, mean, low, high = getattr(found, f"{name}_bands")
        row[f"{short} off"] = float(np.sqrt(np.mean((mean / data - 1) ** 2)))
        row[f"{short} in band"] = float(np.mean((low <= data) & (data <= high)))
    return row


def name_of(found: fp.Identification) -> str:
    return "smooth" if "curvature_noise" in found.parameters else "basic"


def webs_of(found: fp.Identification) -> list[dict[str, Any]]:
    """CV from the string's fibre, from fibres of the model, and of the laid web."""
    rows = []
    for zone, (cv, error) in zip(ZONES, web_of(found), strict=True):
        mean, spread = of_model(found, zone)
        data = found.data
        own = campbell(data.eta, data.ds, zone, data.curve.speed)
        rows.append({
            "model": name_of(found), "zone (m)": zone, "CV, string": own,
            "CV, model": mean, "± of one": spread, "CV, laid web": cv, "± of it": error,
        })  # fmt: skip
    return rows


def study(case: Case, report: Report, length: float, edge: float) -> None:
    """One fibre: its tables, claims and figures."""
    lay, took = laid(case, length, edge)
    curve = lay.laid_curve(skip=SKIPPED)
    along, across = curve.deviations[0].std(axis=0)
    report.check(f"{case.name}: edges", lay.stretched.max(), "<", 1e-12)
    about = {"fibre": case.name, "length (m)": curve.length, "lay-down, CPU s": took}
    report.table([about | {"std of ξ1 (m)": along, "std of ξ2 (m)": across}])
    both = [identified(curve, model) for model in ("smooth", "basic")]
    report.table([parameters_of(*one) for one in both])
    smooth, basic = (found for found, _ in both)
    report.table([fit_of(smooth), fit_of(basic)])
    if edge <= FINE:
        claim = f"{case.name}: AIC of the smooth model less that of the basic"
        report.check(claim, smooth.aic - basic.aic, "<", 0.0)
    check_webs(case, report, (smooth, basic))
    name = f"string_{case.name.replace(' ', '_')}"
    save_figure(plotting.plot_identified_fibres(smooth, basic), f"{name}_figure_8.png")
    save_figure(plotting.plot_increments(smooth, basic), f"{name}_figure_9.png")


def check_webs(
    case: Case, report: Report, models: tuple[fp.Identification, ...]
) -> None:
    """CV three ways, of every model and zone."""
    rows = [row for found in models for row in webs_of(found)]
    report.table(rows)
    for row in rows:
        one, other, scatter = row["CV, model"], row["CV, laid web"], row["± of one"]
        claim = f"{case.name}, {row['model']}, zones of {row['zone (m)']} m"
        # Of the mean of 64 fibres, and of the web.
        error = np.hypot(scatter / 8, row["± of it"])
        report.check(f"{claim}: laid web", abs(one - other), "<", 4 * error)
        if case.energy >= LOUD:
            off = abs(row["CV, string"] / one - 1)
            report.check(f"{claim}: string, relative", off, "<", OFF)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one short, coarse fibre")
    parser.add_argument("--cases", type=int, nargs="+", default=range(len(CASES)))
    options = parser.parse_args()
    report = Report("string_identification", options.quick)
    cases, size = [CASES[number] for number in options.cases], (10.0, 5e-3)
    if options.quick:
        cases, size = [CASES[1]], (5.0, 1e-2)
    for case in cases:
        study(case, report, *size)
    report.finish()


if __name__ == "__main__":
    main()
