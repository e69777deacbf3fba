"""What no web can be made of is refused before anything is computed."""

import numpy as np
import pytest

import fpsolve as fp
from fpsolve.errors import MemoryLimitError

BASIC = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
TABLE = fp.TabulatedCurve([0.0, 50.0, 1e4], [0.0, -5.0, -1e3], [0.0, 0.1, 0.0])
GOOD = {"width": 2.0, "length": 1.0, "spacing": 0.5, "pixel": 0.25, "seed": 1}
PROCESS = {"sigma1": 5e-3, "sigma2": 5e-3, "noise": 15.0, "speed_ratio": 0.1,
           "spinning_speed": 20.0}  # fmt: skip


def model(**changed):
    parts = {"potential": fp.QuadraticPotential(), "noise": 1.0,
             "curve": fp.MovingBelt(0.1)}  # fmt: skip
    return fp.LayDownModel(**parts | changed)


BAD = {
    "spacing 0": ({"spacing": 0.0}, "`spacing` must be positive and finite, got 0"),
    "spacing below 0": ({"spacing": -1.0}, "`spacing` must be positive.*, got -1"),
    "spacing NaN": ({"spacing": np.nan}, "`spacing` must be .*got nan"),
    "spacing far too small": ({"spacing": 1e-12}, "fewer than 2147483648 fibres"),
    "width NaN": ({"width": np.nan}, "`width` must be .*got nan"),
    "length infinite": ({"length": np.inf}, "`length` must be .*got inf"),
    "pixel 0": ({"pixel": 0.0}, "`pixel` must be positive"),
    "pixel NaN": ({"pixel": np.nan}, "`pixel` must be .*got nan"),
    "pixel larger than the window": (
        {"pixel": 1.5}, "`pixel` must not be larger than the window, got 1.5",
    ),
    "width no multiple": (
        {"width": 2.1}, "`width` must be a multiple of `pixel` = 0.25, got 2.1; use "
        "width = 2",
    ),
    "unknown positions": ({"positions": "hexagonal"}, "'regular', 'random' or an"),
    "positions NaN": ({"positions": [0.0, np.nan]}, "`positions` must be finite"),
    "positions none": ({"positions": []}, "`positions` must be a row of places"),
    "positions a matrix": ({"positions": [[0.0]]}, "`positions` must be a row"),
    "one place without a spacing": (
        {"positions": [1.0, 1.0], "spacing": None}, "`spacing` must be given when all",
    ),
    "unknown phases": ({"phases": "random"}, "'independent', 'in phase' or an array"),
    "phases NaN": ({"phases": [np.nan]}, "`phases` must be finite"),
    "too few phases": (
        {"phases": [0.0], "positions": [0.0, 1.0],
         "model": model(curve=fp.RotatingNozzle(0.1, 1.0, 0.5))},
        "one angle for each of the 2 fibres",
    ),
    "phases of a table": ({"model": model(curve=TABLE)}, "must be 'in phase' for a"),
    "belt at rest": ({"model": model(curve=fp.FixedBelt())}, "must have a moving belt"),
    "nozzle over a belt at rest": (
        {"model": model(curve=fp.RotatingNozzle(0.0, 1.0, 0.5))}, "moving belt",
    ),
    "no noise": ({"model": model(noise=0.0)}, "must have noise for a web"),
    "no force": (
        {"model": model(potential=fp.FreePotential())}, "`potential` must confine",
    ),
    "step 0": ({"ds": 0.0}, "`ds` must be positive"),
    "step NaN": ({"ds": np.nan}, "`ds` must be .*got nan"),
    "titer without units": ({"titer": 1e-4}, "`titer` must be given with a Process"),
    "titer in dtex": (
        {"titer": 1.5, "model": fp.Process(**PROCESS), "width": 0.01, "length": 0.01,
         "spacing": 1e-3, "pixel": 1e-3},
        "`titer` must be below 0.1 g/m, got 1.5; dtex given",
    ),
    "pixels that overflow": (
        {"pixel": 1e6, "width": 1e6, "length": 1e6}, "`pixel` must hold at most",
    ),
    "period that does not close": (
        {"periodic": True, "spacing": 0.3}, "`width` must be a multiple of `spacing`",
    ),
    "places beyond a period": (
        {"periodic": True, "positions": [-1.0, 1.0]}, r"must lie in \[0, 2\)",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_a_bad_argument_is_refused_with_a_remedy(name):
    changed, message = BAD[name]
    options = {"model": BASIC, **GOOD, **changed}
    with pytest.raises(ValueError, match=message):
        fp.lay_web(options.pop("model"), **options)


WRONG_KINDS = {
    "no model": ({"model": 3}, "`model` must be a LayDownModel"),
    "no seed": ({"seed": None}, "`seed` must be given, got None; pass seed=1"),
    "text as width": ({"width": "2"}, "`width` must be"),
    "periodic as text": ({"periodic": "no"}, "`periodic` must be True or False"),
    "client that takes no work": ({"client": "tcp://1"}, "`client` must have a method"),
}


@pytest.mark.parametrize("name", WRONG_KINDS)
def test_an_argument_of_another_kind_is_refused(name):
    changed, message = WRONG_KINDS[name]
    options = {"model": BASIC, **GOOD, **changed}
    with pytest.raises(TypeError, match=message):
        fp.lay_web(options.pop("model"), **options)


def test_a_raster_beyond_memory_is_refused_before_anything_is_computed():
    with pytest.raises(MemoryLimitError, match="use larger pixels"):
        fp.lay_web(BASIC, **GOOD | {"width": 1e7, "length": 1e7})
    with pytest.raises(MemoryLimitError):
        fp.lay_web(BASIC, **GOOD, memory_limit=1)


def test_a_window_is_what_was_asked_for():
    web = fp.lay_web(BASIC, **GOOD)
    assert (web.width, web.length, web.pixel, web.spacing) == (2.0, 1.0, 0.25, 0.5)
    assert web.length_density.shape == (8, 4)
    np.testing.assert_allclose(web.cross, np.arange(8) * 0.25 + 0.125, rtol=1e-15)
    np.testing.assert_allclose(web.machine, np.arange(4) * 0.25 + 0.125, rtol=1e-15)
    np.testing.assert_allclose(np.diff(web.positions), 0.5, rtol=1e-12)
