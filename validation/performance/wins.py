"""Who wins: the cheapest of our runs and of the peers' below each error, and the aims.

Nothing is imported that is not in Python's own library; tables.py loads this file.
"""

from __future__ import annotations

from typing import Any

OURS = ("drift_kick", "semi_lagrangian")
SECTORS = "spectral_solve"
BASELINE = ("py-pde", [64, 64, 64])
LEVELS = tuple(10.0**-k for k in range(1, 10))
# How many times cheaper than the best peer, from 1e-3 on: at A up to 1, and beyond.
AIMED_LEVELS = LEVELS[2:]
LITTLE_NOISE, AIM, AIM_BEYOND = 1.0, 10.0, 3.0
SEMI_LAGRANGIAN_AIM = 25.0
# Noise, and CPU seconds of sectors to `SECTORS_ERROR`.
SECTORS_ERROR, SECTORS_AIMS = 1e-9, ((1.0, 0.1), (0.3, 1.0))
# Errors below may be those of the reference.
SHARP = 2e-9
Row = dict[str, Any]
Rows = list[Row]


def grid_schemes(rows: Rows) -> Rows:
    """Our runs on a grid."""
    return [row for row in rows if row["solver"].startswith(OURS)]


def peers(rows: Rows) -> Rows:
    """Runs that are not ours."""
    return [row for row in rows if not row["solver"].startswith((*OURS, SECTORS))]


def sectors(rows: Rows) -> Rows:
    """Runs of our spectral method."""
    return [row for row in rows if row["solver"].startswith(SECTORS)]


def grid(shape: list[int]) -> str:
    """A grid as printed, 64x64x32."""
    return "x".join(map(str, shape))


def baseline(rows: Rows) -> Row | None:
    """The py-pde run on 64³, if it was made."""
    for row in rows:
        if (row["solver"], row["shape"]) == BASELINE:
            return row
    return None


def cheapest(rows: Rows, level: float) -> Row | None:
    """The run with the least CPU time among those with at most this error."""
    accurate = [row for row in rows if row["l1_error"] <= level]
    return min(accurate, key=lambda row: row["cpu"], default=None)


def cost(row: Row | None) -> str:
    """CPU time as printed."""
    return f"{row['cpu']:7.2g} s" if row else f"{'-':>9}"


def win(ours: Row | None, peer: Row | None) -> str:
    """How many times cheaper the cheaper of two runs is, and which it is."""
    if ours is None or (peer is not None and peer["cpu"] < ours["cpu"]):
        assert peer is not None
        best, other, label = peer, ours, f"peer: {peer['solver']}"
    else:
        best, other, label = ours, peer, ours["solver"]
    times = f"{other['cpu'] / best['cpu']:.2g}" if other else "alone"
    return f"{times:>5}  {label}, {grid(best['shape'])}"


def winner_lines(rows: Rows) -> list[str]:
    """The cheapest run of our grid schemes, of the peers and of sectors by error."""
    heads = ("error below", "ours", "best peer", "sectors", "times")
    widths = (11, 9, 9, 9, 5)
    text = "  ".join(f"{head:>{w}}" for head, w in zip(heads, widths, strict=True))
    lines = [f"{text}  cheapest of ours and peers"]
    for level in LEVELS:
        ours, peer = cheapest(grid_schemes(rows), level), cheapest(peers(rows), level)
        if ours or peer:
            spectral = cost(cheapest(sectors(rows), level))
            costs = f"{cost(ours)}  {cost(peer)}  {spectral}"
            lines.append(f"{level:11.0e}  {costs}  {win(ours, peer)}")
    return lines


def ratio(rows: Rows, level: float) -> float | None:
    """CPU time of the best peer over ours: infinite without a peer, 0 without ours.

    None where nobody is within the error.
    """
    ours, peer = cheapest(grid_schemes(rows), level), cheapest(peers(rows), level)
    if ours is None:
        return None if peer is None else 0.0
    return float("inf") if peer is None else float(peer["cpu"] / ours["cpu"])


def shown_ratio(value: float | None) -> str:
    """A ratio as printed."""
    if value is None:
        return "nobody"
    return {0.0: "peer", float("inf"): "alone"}.get(value, f"{value:.2g}")


def lost_lines(rows: Rows, noise: float) -> list[str]:
    """Errors at which a peer is cheaper than every grid scheme of ours."""
    lines = []
    for level in LEVELS:
        ours, peer = cheapest(grid_schemes(rows), level), cheapest(peers(rows), level)
        if peer and not (ours and ours["cpu"] <= peer["cpu"]):
            times = f"{ours['cpu'] / peer['cpu']:.2g} times" if ours else "alone"
            lines.append(f"A = {noise:g}, {level:.0e}: {times}, {peer['solver']}")
    return lines


def aim_at(noise: float) -> float:
    """How many times cheaper than the best peer was aimed at."""
    return AIM if noise <= LITTLE_NOISE else AIM_BEYOND


def ratio_line(rows: Rows, noise: float) -> str:
    """Ratios from 1e-3 to 1e-9 at one noise, and whether the aim was reached."""
    found = [ratio(rows, level) for level in AIMED_LEVELS]
    aim = aim_at(noise)
    reached = all(value is not None and value >= aim for value in found)
    text = " ".join(f"{shown_ratio(value):>6}" for value in found)
    return f"{verdict(reached)} {text}, aim {aim:2g}: A = {noise:g}"


def same_grid_line(rows: Rows, noise: float) -> str:
    """CPU time of `semi_lagrangian` over `drift_kick` on the same cells, same step."""
    seconds = {
        (row["solver"], *row["shape"], row["step"]): row["cpu"]
        for row in rows
        if row["solver"] in OURS
    }
    drift_kick, semi_lagrangian = OURS
    ratios = [
        seconds[(semi_lagrangian, *key)] / cpu
        for (solver, *key), cpu in seconds.items()
        if solver == drift_kick and (semi_lagrangian, *key) in seconds
    ]
    return f"A = {noise:g}: {min(ratios):.2g} to {max(ratios):.2g} times"


def told_line(rows: Rows, noise: float) -> str:
    """Smallest and largest of what Fourier runs tell over their errors.

    Of runs whose error is well above that of the reference.
    """
    told = [
        row["told"] / row["l1_error"]
        for row in grid_schemes(rows)
        if "Fourier" in row["solver"] and row["told"] and row["l1_error"] > SHARP
    ]
    return f"A = {noise:g}: {min(told):.2g} to {max(told):.2g}, {len(told)} runs"


def verdict(reached: bool) -> str:
    """The word at the start of a line."""
    return "reached" if reached else "MISSED "


def semi_lagrangian_line(rows: Rows) -> str:
    """`semi_lagrangian` against py-pde on the same 64³ cells."""
    base = baseline(rows)
    mine = [
        row for row in rows
        if row["solver"].startswith("semi_lagrangian")
        and row["shape"] == BASELINE[1]
    ]  # fmt: skip
    if base is None or not mine:
        return "not judged: needs py-pde and semi_lagrangian on 64³"
    best = cheapest(mine, base["l1_error"])
    if best is None:
        return f"{verdict(False)} semi_lagrangian: never within the error of py-pde"
    texts = [
        f"{base['cpu'] / row['cpu']:.3g} with ds = {row['step']} "
        f"(error {row['l1_error']:.2g})"
        for row in sorted(mine, key=lambda row: row["cpu"])
    ]
    return (
        f"{verdict(base['cpu'] / best['cpu'] >= SEMI_LAGRANGIAN_AIM)} "
        f"{', '.join(texts)}, aim {SEMI_LAGRANGIAN_AIM:g}: "
        f"py-pde (error {base['l1_error']:.2g}) over semi_lagrangian on 64³"
    )


def sectors_line(rows: Rows, noise: float, seconds: float) -> str:
    """Sectors to an L1 error, and to a told error of H as small."""
    mine = sectors(rows)
    true = cheapest(mine, SECTORS_ERROR)
    bounds = [row | {"l1_error": max(row["l1_error"], row["told"])} for row in mine]
    told = cheapest(bounds, SECTORS_ERROR)
    reached = true is not None and true["cpu"] <= seconds
    return (
        f"{verdict(reached)} {cost(true).strip()}, aim {seconds:g} s: sectors to "
        f"{SECTORS_ERROR:.0e} at A = {noise:g}; with a told error of H as small "
        f"{cost(told).strip()}"
    )


def day_lines(
    sections: dict[float, dict[str, Any]], records: dict[str, Any]
) -> list[str]:
    """What was measured on which day: parts, and solvers at a noise."""
    found: dict[str, list[str]] = {}
    for noise, solvers in sections.items():
        days: dict[str, list[str]] = {}
        for solver, section in solvers.items():
            days.setdefault(section["date"][:10], []).append(solver)
        for day, names in days.items():
            some = "" if len(days) == 1 else f" ({', '.join(names)})"
            found.setdefault(day, []).append(f"A = {noise:g}{some}")
    for part, record in records.items():
        found.setdefault(record.get("run", record)["date"][:10], []).append(part)
    return [f"{day}: {', '.join(parts)}" for day, parts in sorted(found.items())]
