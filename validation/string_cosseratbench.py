"""The string in the scored cases of cosseratbench that an inextensible fibre can run.

cosseratbench (J. Van Slyke, https://github.com/jakeryderv/cosseratbench, Apache-2.0)
scores solvers of Cosserat rods. Three of its cases apply: a catenary, a cantilever with
a load at its tip, a pendulum; its crossing, capstan and pile need contact that holds
rods apart, its twist needs torsion. Cases and scores are those of its
`src/cosseratbench/experiments/` (catenary.py and cantilever.py at commit 0dd9d04,
pendulum.py at 151f008), computed here by code of our own; `PUBLISHED` are its numbers
for PyElastica and MuJoCo from `results-0.2/CASE/VARIANT/SOLVER/result.json` (commits
c44ae82 and dc6c424).

References of the catenary and the pendulum stretch under their weight, which the string
does not. So three numbers are printed: the score; `left out`, the score of the exact
answer without stretch; and `error`, the score against that answer.
"""

from __future__ import annotations

import argparse
import os

for variable in ("OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import time  # noqa: E402
from collections.abc import Iterator  # noqa: E402

import numpy as np  # noqa: E402
from numpy.polynomial import legendre  # noqa: E402
from reporting import Report  # noqa: E402
from scipy.linalg import eigh  # noqa: E402
from scipy.optimize import brentq, minimize_scalar, root  # noqa: E402

from fpsolve import fibre  # noqa: E402
from fpsolve.fibre.forces import Forces  # noqa: E402

HERE, WEIGHTLESS, DENSITY, GRAVITY = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 1000.0, 9.81
SPAN, LOAD, AMPLITUDE, SECONDS, FRAMES = 0.8, 7.5e-3, 0.02, 5.0, 101
# By case, Young's modulus in Pa and edges: scores of PyElastica, and of MuJoCo.
PUBLISHED = {
    ("catenary: shape", 1e6, 25): (4.14e-4, np.nan),
    ("catenary: shape", 1e6, 50): (4.52e-4, 3.29e-3),
    ("catenary: shape", 1e6, 100): (4.61e-4, np.nan),
    ("catenary: shape", 1e7, 50): (1.59e-3, 1.66e-3),
    ("catenary: sag", 1e6, 25): (1.72e-3, np.nan),
    ("catenary: sag", 1e6, 50): (1.37e-4, 1.23e-2),
    ("catenary: sag", 1e6, 100): (2.95e-4, np.nan),
    ("catenary: sag", 1e7, 50): (8.96e-4, 3.75e-4),
    ("catenary: settling", 1e6, 50): (2.77e-8, 3.19e-8),
    ("cantilever: tip", 1e6, 10): (1.44e-1, np.nan),
    ("cantilever: tip", 1e6, 20): (7.31e-2, 7.41e-2),
    ("cantilever: tip", 1e6, 40): (3.67e-2, np.nan),
    ("pendulum: period", 1e6, 50): (1.56e-4, np.nan),
    ("pendulum: period", 1e7, 25): (4.79e-4, np.nan),
    ("pendulum: period", 1e7, 50): (1.37e-4, 2.09e-5),
    ("pendulum: period", 1e7, 100): (5.11e-5, np.nan),
    ("pendulum: period", 1e8, 50): (1.34e-4, 1.24e-5),
    ("pendulum: amplitude", 1e6, 50): (1.78e-5, np.nan),
    ("pendulum: amplitude", 1e7, 25): (4.17e-5, np.nan),
    ("pendulum: amplitude", 1e7, 50): (1.00e-5, 2.01e-6),
    ("pendulum: amplitude", 1e7, 100): (2.26e-7, np.nan),
    ("pendulum: amplitude", 1e8, 50): (5.11e-6, 8.87e-6),
}
# Speeds in lengths per second of a fibre at rest: a thousandth of what is published.
# A clamped end has order 2 here, 1 in PyElastica. In windows of one period a swing that
# keeps its energy changes by 4e-5 with 25 edges. References neglect bending, or have
# errors of order 2 in the edges, that both programs have alike.
SETTLED, CANTILEVER, KEPT, WITHOUT_STRETCH = 1e-9, 20.0, 6e-5, 1.3
# A score, that of the exact answer without stretch, and against that answer.
Scores = Iterator[tuple[str, float, float, float]]


def catenary_curve(youngs: float) -> np.ndarray:
    """Irvine's elastic catenary of 1 m at 2001 lengths s; `youngs` inf: no stretch."""
    area = np.pi * 0.005**2
    weight, give = DENSITY * area * GRAVITY, 1 / (youngs * area)
    s = np.linspace(0.0, 1.0, 2001)
    vertical = weight * (s - 0.5)

    def along(pull: float) -> np.ndarray:
        turned = np.arcsinh(vertical / pull)
        return pull * (give * s + (turned - turned[0]) / weight)

    pull = brentq(lambda h: along(h)[-1] - SPAN, 1e-3 * weight, 1e3 * weight)
    stored = give * vertical**2 / 2 + np.hypot(pull, vertical)
    return np.stack([along(pull), 0 * s, (stored - stored[0]) / weight], axis=-1)


def farthest(nodes: np.ndarray, curve: np.ndarray) -> float:
    away = np.linalg.norm(nodes[:, None] - curve, axis=-1)
    return float(away.min(axis=1).max())


def catenary(youngs: float, n: int) -> Scores:
    ends = fibre.Hinged(HERE), fibre.Hinged((SPAN, 0.0, 0.0))
    string = fibre.String(1.0, 0.01, DENSITY, youngs, *ends, n_edges=n)
    r = fibre.equilibrium(string).r
    stretched, exact = catenary_curve(youngs), catenary_curve(np.inf)
    yield (
        "catenary: shape", farthest(r, stretched),
        farthest(exact[:: 2000 // n], stretched), farthest(r, exact),
    )  # fmt: skip
    deep, sag, truth = (-float(one[:, 2].min()) for one in (stretched, r, exact))
    yield (
        "catenary: sag", abs(sag / deep - 1), abs(truth / deep - 1),
        abs(sag / truth - 1),
    )  # fmt: skip
    # It is at rest: what moves is what the search for rest has left.
    after = fibre.simulate(
        string, SECONDS, FRAMES - 1, shape=r, save_every=1, estimate_error=False
    )
    moved = np.linalg.norm(after.r[-1] - after.r[-2], axis=-1).max()
    speed = float(moved / (after.saved[-1] - after.saved[-2]))
    yield "catenary: settling", speed, 0.0, speed


def cantilever(youngs: float, n: int) -> Scores:
    stiffness = youngs * np.pi * 0.02**4 / 4
    deflection = LOAD / (3 * stiffness)
    rest, left = loaded(youngs, n, deflection)
    if not left <= 1e-6:
        raise RuntimeError(f"the end is held by another force, off by {left:.2g}")
    score = abs(-rest.r[-1, 2] / deflection - 1)
    yield "cantilever: tip", score, 0.0, score


def loaded(youngs: float, n: int, deflection: float) -> tuple[fibre.Equilibrium, float]:
    """The fibre whose free end is held just by the load, and by how much it is not.

    A string has no loads but weight and air. So its end is hinged, and the place is
    sought where the hinge pulls downwards by the load: the end of the beam's first
    bending and of one more, whose angles are added.
    """
    s = (np.arange(n) + 0.5) / n
    clamped = fibre.Clamped(HERE, (1.0, 0.0, 0.0))

    def held(amounts: np.ndarray) -> tuple[fibre.Equilibrium, np.ndarray]:
        angle = 1.5 * amounts[0] * (2 - s) * s + amounts[1] * (1 - 2 * s)
        r = chained(np.sin(-deflection * angle) / n, 2, 0)
        end = fibre.Hinged(tuple(r[-1].tolist()))
        string = fibre.String(
            1.0, 0.04, DENSITY, youngs, clamped, end, gravity=WEIGHTLESS, n_edges=n
        )
        rest = fibre.equilibrium(string, shape=r)
        pull = Forces(string).total(rest.r, rest.tension)[-1]
        return rest, (pull[[0, 2]] - [0.0, LOAD]) / LOAD

    found = root(lambda amounts: held(amounts)[1], [1.0, 0.0], tol=1e-8)
    rest, off = held(found.x)
    return rest, float(np.abs(off).max())


def chained(across: np.ndarray, axis: int, other: int, sign: float = 1.0) -> np.ndarray:
    """Nodes from the origin, edges of 1/n going by `across` and else straight on."""
    edges = np.zeros((across.size, 3))
    edges[:, axis] = across
    edges[:, other] = sign * np.sqrt(across.size**-2.0 - across**2)
    return np.concatenate([np.zeros((1, 3)), np.cumsum(edges, axis=0)])


def first_mode(youngs: float, stretches: bool) -> tuple[float, np.ndarray]:
    """ω and Legendre coefficients over 2y − 1, y the height above the free end.

    (EI u'')'' − (T/(1 + T/EA) u')' = ρA ω² u, T = ρA g y, u = 0 at the pin: Galerkin
    with P_k − P_{k+1}, natural conditions elsewhere. From 40 to 100 polynomials the
    period changes by 1e-14.
    """
    area, n = np.pi * 0.002**2, 60
    nodes, weights = legendre.leggauss(2 * n)
    weights, basis = weights / 2, np.eye(n, n + 1) - np.eye(n, n + 1, 1)
    u, slope, bend = (
        np.stack([legendre.legval(nodes, legendre.legder(one, k)) for one in basis])
        * 2**k
        for k in range(3)
    )
    tension = DENSITY * area * GRAVITY * (nodes + 1) / 2
    if stretches:
        tension = tension / (1 + tension / (youngs * area))
    stiffness = youngs * area * 0.002**2 / 4 * (bend * weights) @ bend.T
    stiffness += (slope * weights * tension) @ slope.T
    mass = DENSITY * area * (u * weights) @ u.T
    inverse, modes = eigh(mass, stiffness)
    mode = modes[:, -1] @ basis
    return float(inverse[-1] ** -0.5), mode / legendre.legval(-1.0, mode)


def pendulum(youngs: float, n: int) -> Scores:
    frequency, mode = first_mode(youngs, stretches=False)
    string = fibre.String(
        1.0, 0.004, DENSITY, youngs, fibre.Hinged(HERE), fibre.Free(), n_edges=n
    )
    swing = AMPLITUDE * legendre.legval(1 - 2 * string.s, mode)
    motion = fibre.simulate(
        string, SECONDS, 20 * (FRAMES - 1), shape=chained(np.diff(swing), 0, 2, -1.0),
        save_every=20, estimate_error=False,
    )  # fmt: skip
    t, x = motion.saved, motion.r[:, -1, 0]
    exact, stretched = (
        2 * np.pi / one for one in (frequency, first_mode(youngs, True)[0])
    )
    near = (0.99 * exact, exact, 1.01 * exact)
    period = float(minimize_scalar(lambda p: fitted(t, x, p)[1], near, tol=1e-9).x)
    yield (
        "pendulum: period", abs(period / stretched - 1), abs(exact / stretched - 1),
        abs(period / exact - 1),
    )  # fmt: skip
    first, last = t <= period, t >= t[-1] - period
    change = fitted(t[last], x[last], period)[0] / fitted(t[first], x[first], period)[0]
    yield "pendulum: amplitude", abs(change - 1), 0.0, abs(change - 1)


def fitted(t: np.ndarray, x: np.ndarray, period: float) -> tuple[float, float]:
    """Amplitude of the sinusoid about a mean nearest to x, and the squares left."""
    turn = 2 * np.pi * t / period
    columns = np.stack([np.cos(turn), np.sin(turn), np.ones_like(t)], axis=-1)
    found = np.linalg.lstsq(columns, x, rcond=None)[0]
    return float(np.hypot(*found[:2])), float(((x - columns @ found) ** 2).sum())


CASES = {
    catenary: ((1e6, 25), (1e6, 50), (1e6, 100), (1e7, 50)),
    cantilever: ((1e6, 10), (1e6, 20), (1e6, 40)),
    pendulum: ((1e6, 50), (1e7, 25), (1e7, 50), (1e7, 100), (1e8, 50)),
}


def measured(quick: bool) -> Iterator[dict[str, object]]:
    for case, variants in CASES.items():
        for youngs, n in variants[:2] if quick else variants:
            began = time.process_time()
            for name, score, left_out, error in case(youngs, n):
                theirs = PUBLISHED.get((name, youngs, n), (np.nan, np.nan))
                place = 1 + sum(one < score for one in theirs)
                yield {
                    "case": name, "E / Pa": youngs, "edges": n, "score": score,
                    "PyElastica": theirs[0], "MuJoCo": theirs[1],
                    "place": f"{place} of {1 + int(np.isfinite(theirs).sum())}",
                    "left out": left_out, "error": error,
                    "CPU s": time.process_time() - began,
                }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="two variants of a case")
    quick = parser.parse_args().quick
    report = Report("string_cosseratbench", quick)
    rows = list(measured(quick))
    report.table(rows)
    check(report, rows)
    report.finish()


def check(report: Report, rows: list[dict[str, object]]) -> None:
    for row in rows:
        name = row["case"]
        about = f"{name}, E = {row['E / Pa']:g}, {row['edges']} edges"
        if name == "catenary: settling":
            report.check(f"{about}: at rest", row["score"], "<", SETTLED)
        elif name == "cantilever: tip":
            bound = row["PyElastica"] / CANTILEVER
            report.check(f"{about}: far below PyElastica's", row["score"], "<", bound)
        elif name == "pendulum: amplitude":
            report.check(f"{about}: kept", row["score"], "<", KEPT)
        else:
            claim = f"{about}: error without stretch about PyElastica's with it"
            bound = WITHOUT_STRETCH * row["PyElastica"]
            report.check(claim, row["error"], "<", bound)


if __name__ == "__main__":
    main()
