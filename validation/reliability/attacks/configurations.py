"""Configuration files, sound ones and ones that are broken in one or two places."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .draws import between, log_between, one_of

__all__ = ["run_toml", "written_paths", "written_run"]

VALUES = (
    "0",
    "-1",
    "1",
    "2",
    "1.0",
    "1e-300",
    "1e300",
    "1e-12",
    "nan",
    "inf",
    "-inf",
    "9223372036854775808",
    "true",
    "false",
    '""',
    '"x"',
    '"nan"',
    "[]",
    "[1.0]",
    "[1.0, 2.0]",
    "[1, 2, 3]",
    "[[1.0, 0.0], [0.0, 1.0]]",
    "{}",
    "{a = 1}",
    "1979-05-27",
    "[8, 8, 8]",
    "[4, 4, 4]",
    "[1e9, 1e9]",
    "0.5",
    "0.3333333",
    "[0.5, 1.0]",
    "[nan]",
    '["a"]',
)
Tables = dict[str, dict[str, str]]


def run_toml(**changes: Any) -> str:
    """A small run, with some values changed."""
    tables = tables_of_run()
    for table in tables.values():
        for key in table:
            if key in changes:
                table[key] = str(changes[key])
    return text_of(tables)


def tables_of_run() -> Tables:
    return {
        "potential": {"kind": '"quadratic"'},
        "model": {"noise": "1.0"},
        "grid": {"half_width": "6.0", "shape": "[20, 20, 16]"},
        "initial": {"kind": '"gaussian"', "mean": "[0.5, 0.0]", "variance": "0.8"},
        "scheme": {"kind": '"drift_kick"'},
        "run": {"s_end": "1.0", "ds": "0.125", "save_at": "[0.5, 1.0]"},
        "output": {"name": '"small"'},
    }


def text_of(tables: Tables) -> str:
    """TOML of tables whose values are TOML already."""
    return "\n".join(
        "\n".join([f"[{name}]", *(f"{key} = {value}" for key, value in table.items())])
        for name, table in tables.items()
    )


def potential_table(rng: Any) -> dict[str, str]:
    number = str(between(rng, 0.7, 1.5))
    return one_of(
        rng,
        {"kind": '"quadratic"', "sigma1": number},
        {
            "kind": '"quadratic"',
            "sigma1": number,
            "sigma2": str(between(rng, 0.7, 1.4)),
        },
        {"kind": '"linear"', "slope": number},
        {"kind": '"power"', "exponent": str(between(rng, 1.0, 4.0)), "scale": number},
    )


def curve_table(rng: Any) -> dict[str, str]:
    speed = str(between(rng, -0.3, 0.3))
    nozzle = {
        "speed": speed,
        "angular_speed": str(between(rng, -3.0, 3.0)),
        "phase": str(between(rng, -1.0, 1.0)),
    }
    return one_of(
        rng,
        {"kind": '"fixed_belt"'},
        {"kind": '"moving_belt"', "speed": speed},
        {"kind": '"rotating_nozzle"', "radius": "0.3", **nozzle},
        {"kind": '"oscillating_nozzle"', "amplitude": "0.3", **nozzle},
        {"kind": '"elliptic_nozzle"', "radius1": "0.2", "radius2": "0.3", **nozzle},
        {
            "kind": '"tabulated_curve"',
            "s": "[0.0, 1.0, 2.0, 4.0]",
            "gamma1": "[0.0, -0.1, -0.2, -0.4]",
            "gamma2": "[0.0, 0.1, 0.0, 0.1]",
        },
    )


def scheme_table(rng: Any) -> dict[str, str]:
    return one_of(
        rng,
        {"kind": '"drift_kick"'},
        {"kind": '"drift_kick"', "positive": "true", "interpolation_order": "6"},
        {"kind": '"drift_kick"', "balanced": "true"},
        {"kind": '"semi_lagrangian"', "splitting": '"lie"'},
        {"kind": '"semi_lagrangian"', "limited": "true", "compact": "false"},
    )


def random_run(rng: Any) -> Tables:
    """A sound run."""
    tables = tables_of_run()
    tables["potential"] = potential_table(rng)
    tables["model"]["noise"] = str(one_of(rng, 0.0, log_between(rng, 0.3, 3.0), 8.0))
    tables["scheme"] = scheme_table(rng)
    if tables["scheme"] != {"kind": '"drift_kick"'}:
        # What is evolved as p/p_S has to begin near p_S.
        tables["initial"] = {"kind": '"equilibrium"'}
    n1, n2 = (int(rng.integers(20, 34)) for _ in range(2))
    n_alpha = 2 * int(rng.integers(4, 11))
    tables["grid"] = {
        "half_width": str(between(rng, 7.0, 9.0)),
        "shape": f"[{n1}, {n2}, {n_alpha}]",
    }
    if rng.random() < 0.6:
        tables["curve"] = curve_table(rng)
    tables["run"] = {
        "s_end": "1.0",
        "ds": one_of(rng, "0.125", "0.1", "0.0625"),
        "extrapolate": one_of(rng, "true", "false"),
        "record_every": str(int(rng.integers(1, 4))),
        **one_of(rng, {"save_at": "[0.0, 1.0]"}, {"save_every": "0.5"}, {}),
    }
    # A loose box: what is judged is the run, not whether the walls are far enough.
    tables["run"] |= {"boundary_tolerance": "0.5", "negative_tolerance": "1.0"}
    tables["output"] = {
        "name": '"result"',
        "format": one_of(rng, '"netcdf"', '"zarr"'),
    }
    return tables


def spoiled(rng: Any, tables: Tables) -> str:
    """The file with one or two values, keys, sections or characters changed."""
    for _ in range(int(rng.integers(1, 3))):
        name = one_of(rng, *tables)
        table = tables[name]
        key = one_of(rng, *table) if table else "kind"
        how = int(rng.integers(6))
        if how <= 2:
            table[key] = one_of(rng, *VALUES)
        elif how == 3:
            table.pop(key, None)
        elif how == 4:
            table[one_of(rng, key.upper(), key[:-1], "kind", "noise")] = '"x"'
        elif len(tables) > 2:
            del tables[name]
    text = text_of(tables)
    if rng.random() < 0.1:
        place = int(rng.integers(len(text)))
        text = text[:place] + one_of(rng, "\0", "=", "]", "é", "") + text[place + 1 :]
    return text


def written_run(rng: Any, notes: Any) -> bool:
    """Write `run.toml`; whether it is sound."""
    tables = random_run(rng)
    sound = bool(rng.random() < 0.4)
    text = text_of(tables) if sound else spoiled(rng, tables)
    Path("run.toml").write_text(text, encoding="utf-8")
    notes.say("run.toml = " + " ".join(text.split("\n")))
    return sound


def written_paths(rng: Any, notes: Any) -> None:
    """Write `paths.toml`, sound or not."""
    tables: Tables = {
        "potential": potential_table(rng),
        "model": {"noise": str(log_between(rng, 0.3, 3.0))},
        "start": one_of(
            rng,
            {"kind": '"point"', "xi": "[0.1, 0.2]"},
            {"kind": '"equilibrium"'},
            {"kind": '"gaussian"', "variance": "0.5"},
        ),
        "paths": {
            "n_paths": str(int(rng.integers(1, 40))),
            "s_end": "1.0",
            "ds": "0.125",
            "seed": "1",
            "method": one_of(rng, '"splitting"', '"heun"'),
            "keep": one_of(rng, "true", "false"),
        },
        "output": {"name": '"result"'},
    }
    if rng.random() < 0.5:
        tables["curve"] = curve_table(rng)
    if rng.random() < 0.3:
        tables["histogram"] = {"half_width": "4.0", "shape": "[6, 6, 8]"}
    text = text_of(tables) if rng.random() < 0.5 else spoiled(rng, tables)
    Path("paths.toml").write_text(text, encoding="utf-8")
    notes.say("paths.toml = " + " ".join(text.split("\n")))
