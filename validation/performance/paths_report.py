"""Table, aims and speed at equal error of the sampling benchmark."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from paths_ours import Bias, Scaling
from paths_problem import DS, Rate

# How each peer is used in its documentation, or by the aim, by the beginning of its
# note. The aims are judged against that and against the fastest float64 use found.
STATED_USE = {
    "numba Euler-Maruyama": ("path by path", "step by step, drawn in the loop"),
    "diffrax": ("VirtualBrownianTree",),
    "sdeint": ("one path a call",),
}
OTHER_PRECISION = "float32"
OUR_NOTE = "splitting, quadratic B"


@dataclass(frozen=True)
class Aim:
    """A number of times faster than a peer that was aimed at."""

    peer: str
    times: float


AIMS = (
    Aim("numba Euler-Maruyama", 5.0),
    Aim("diffrax", 15.0),
    Aim("sdeint", 100.0),
)
SCALING_AIM = 1.7


def our_rate(rates: list[Rate]) -> Rate:
    """The row that the peers are compared with."""
    return next(rate for rate in rates if rate.note == OUR_NOTE)


def stated_rate(rates: list[Rate], peer: str) -> Rate | None:
    """The fastest stated use of a peer; None if it did not run."""
    stated = [
        rate
        for rate in rates
        if rate.name == peer
        and rate.note.startswith(STATED_USE[peer])
        and "Generator" not in rate.note
    ]
    return max(stated, key=lambda rate: rate.rate, default=None)


def fastest_rate(rates: list[Rate], peer: str) -> Rate | None:
    """The fastest use of a peer in double precision; None if it did not run."""
    found = [
        rate for rate in rates if rate.name == peer and OTHER_PRECISION not in rate.note
    ]
    return max(found, key=lambda rate: rate.rate, default=None)


def judge(rates: list[Rate], scaling: Scaling) -> list[dict[str, Any]]:
    """Every aim with what was reached; `reached` is None where the peer is missing."""
    ours = our_rate(rates).rate
    verdicts: list[dict[str, Any]] = []
    for aim in AIMS:
        for choose in (stated_rate, fastest_rate):
            peer = choose(rates, aim.peer)
            times = ours / peer.rate if peer else None
            use = "stated use" if choose is stated_rate else "fastest use"
            verdicts.append({
                "aim": f"{aim.times:g} times the rate of {aim.peer}",
                "against": f"{use}: {peer.note if peer else 'not installed'}",
                "measured": times,
                "reached": times >= aim.times if times else None,
            })  # fmt: skip
    verdicts.append({
        "aim": f"two threads {SCALING_AIM} times as fast as one",
        "against": "one thread",
        "measured": scaling.gain,
        "reached": scaling.gain >= SCALING_AIM,
    })  # fmt: skip
    return verdicts


def at_equal_error(rates: list[Rate], biases: list[Bias]) -> dict[str, float] | None:
    """CPU time of Euler-Maruyama over that of the splitting at the same bias.

    The bias of Euler-Maruyama is proportional to its step, with the factor measured at
    its smallest one. It is allowed the splitting's bias at ds = 0.2 plus two standard
    errors, and its rate is that of the fastest numba peer.
    """
    splitting = next(b for b in biases if (b.method, b.ds) == ("splitting", DS))
    euler = min((b for b in biases if b.method == "euler_maruyama"), key=lambda b: b.ds)
    peer = fastest_rate(rates, "numba Euler-Maruyama")
    if peer is None or not euler.bias > 0:
        return None
    allowed = abs(splitting.bias) + 2 * splitting.standard_error
    ds = min(DS, allowed * euler.ds / euler.bias)
    times = our_rate(rates).rate / peer.rate
    return {
        "bias": allowed,
        "ds_splitting": DS,
        "ds_euler_maruyama": ds,
        "times": times * DS / ds,
    }


def print_rates(rates: list[Rate]) -> None:
    """All rates; the last column is our rate over the row's."""
    ours = our_rate(rates).rate
    heading = f"{'sampler':22} {'':42} {'M/s':>8} {'ratio':>8} {'E|ξ|²':>15}"
    print(heading)
    for rate in rates:
        square = f"{rate.mean_square:.3f} ± {rate.standard_error:.3f}"
        print(
            f"{rate.name:22} {rate.note:42} {rate.rate / 1e6:8.4g} "
            f"{ours / rate.rate:8.3g} {square:>15}"
        )
    print(
        "M/s: million path-steps per second of process CPU time, one thread, median;\n"
        "ratio: our first row over this one; E|ξ|² at the end of what was timed: 2\n"
        "for the peers and the first three of ours, but for the bias below."
    )


def print_biases(biases: list[Bias]) -> None:
    """Stationary bias of each method and step."""
    for bias in biases:
        print(
            f"bias of E|ξ|², {bias.method:15} ds = {bias.ds:<5g} "
            f"{bias.bias:+.5f} ± {bias.standard_error:.5f}"
        )


def print_verdicts(verdicts: list[dict[str, Any]]) -> None:
    """Which aims were reached."""
    words = {True: "reached", False: "MISSED", None: "not judged"}
    for verdict in verdicts:
        measured = verdict["measured"]
        number = "-" if measured is None else f"{measured:.3g}"
        print(
            f"{words[verdict['reached']]:10} {verdict['aim']}: {number} "
            f"({verdict['against']})"
        )


def print_all(
    measured: dict[str, Any],
    equal: dict[str, float] | None,
    verdicts: list[dict[str, Any]],
) -> None:
    """Rates, scaling, bias, speed at equal error, aims."""
    scaling = measured["scaling"]
    print_rates(measured["rates"])
    print(
        f"\nelapsed: one thread {scaling.one / 1e6:.4g}, two {scaling.two / 1e6:.4g} "
        f"M/s, gain {scaling.gain:.2f}\n"
    )
    print_biases(measured["biases"])
    if equal:
        print(
            f"at a bias of {equal['bias']:.2g} numba Euler-Maruyama needs ds = "
            f"{equal['ds_euler_maruyama']:.2g} and {equal['times']:.3g} times the CPU "
            "time of the splitting"
        )
    print()
    print_verdicts(verdicts)
