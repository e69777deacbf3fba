"""Flows from tables: what is exact, orders between the points, what is refused."""

import numpy as np
import pytest
import xarray as xr

import fpsolve as fp
from fpsolve.fibre import AirFlow

NAMES = ("velocity_x", "velocity_y", "velocity_z")
RNG = np.random.default_rng(7)
INSIDE = RNG.uniform(0.2, 0.8, size=(200, 3))


def orders(errors):
    errors = np.array(errors)
    return np.log2(errors[:-1] / errors[1:])


def linear(r):
    x, y, z = r.T
    return np.stack([1 + x - z, 2 * y, 3.0 - z + 0.5 * x], axis=-1)


def smooth(r):
    x, y, z = r.T
    return np.stack([np.sin(3 * x) * z, np.cos(2 * y + z), x * y * z], axis=-1)


def scattered(n, dimensions=3):
    """Points of a cube, with its corners so that it is their hull."""
    corners = np.stack(np.meshgrid(*[[0.0, 1.0]] * dimensions), -1)
    inside = np.random.default_rng(3).random((n, dimensions))
    return np.concatenate([corners.reshape(-1, dimensions), inside])


def points(r, flow, **more):
    table = xr.Dataset({name: ("point", r[:, i]) for i, name in enumerate("xyz")})
    for i, name in enumerate(NAMES):
        table[name] = ("point", flow(r)[:, i])
    for name, values in more.items():
        table[name] = ("point", values)
    return table


def grid(n, flow):
    one = np.linspace(0, 1, n)
    r = np.stack(np.meshgrid(one, one, one, indexing="ij"), axis=-1)
    values = flow(r.reshape(-1, 3)).reshape(r.shape)
    fields = {name: (("x", "y", "z"), values[..., i]) for i, name in enumerate(NAMES)}
    return xr.Dataset(fields, coords={"x": one, "y": one, "z": one})


@pytest.mark.parametrize("table", [points(scattered(60), linear), grid(4, linear)])
def test_a_linear_flow_is_exact_between_the_points(table):
    air = AirFlow.from_dataset(table)
    np.testing.assert_allclose(air.at(INSIDE, 0.0), linear(INSIDE), rtol=1e-12)
    assert air.table_errors()["velocity"] < 1e-12
    assert air.table_errors()["k"] == 0.0


def jittered(n):
    """Cells of a cube shaken, with the same numbers for every n."""
    one = np.linspace(0, 1, n)
    r = np.stack(np.meshgrid(one, one, one, indexing="ij"), axis=-1)
    inner = (slice(1, -1),) * 3
    r[inner] += np.random.default_rng(4).uniform(-0.3, 0.3, r[inner].shape) / (n - 1)
    return r.reshape(-1, 3)


@pytest.mark.parametrize(
    "tables",
    [
        [points(jittered(n), smooth) for n in (5, 9, 17)],
        [grid(n, smooth) for n in (5, 9, 17)],
    ],
)
def test_a_smooth_flow_is_of_order_two_in_the_distance_of_the_points(tables):
    errors = []
    for table in tables:
        air = AirFlow.from_dataset(table)
        away = np.linalg.norm(air.at(INSIDE, 0.0) - smooth(INSIDE), axis=1)
        errors.append(away.max())
        assert errors[-1] <= air.table_errors()["velocity"] < 10 * errors[-1]
    # The largest of 200 places, in cells of another shape for scattered points.
    assert (abs(orders(errors) - 2) < 0.4).all(), errors


def test_a_flow_of_two_coordinates_is_the_same_along_the_third():
    places = scattered(50, 2)
    table = xr.Dataset({"x": ("p", places[:, 0]), "z": ("p", places[:, 1])})
    table["velocity_x"] = ("p", 1 + places[:, 0])
    table["velocity_z"] = ("p", 2 - places[:, 1])
    air = AirFlow.from_dataset(table)
    exact = np.stack([1 + INSIDE[:, 0], 0 * INSIDE[:, 0], 2 - INSIDE[:, 2]], axis=-1)
    np.testing.assert_allclose(air.at(INSIDE * [1, 50, 1], 0.0), exact, atol=1e-12)


def exported(path, heading, columns):
    np.savetxt(path, columns, delimiter=",", header=heading, comments="", fmt="%.17g")
    return path


def test_a_file_of_columns_is_the_table_that_it_holds(tmp_path):
    r = scattered(40)
    k, epsilon = 1 + r[:, 0], 5 + r[:, 2]
    u, v, w = linear(r).T
    path = exported(
        tmp_path / "export.csv",
        "epsilon [m2/s3],w [m/s],x [m],y (m),z [m],pressure [Pa],u [m/s],v [m/s],k",
        np.stack([epsilon, w, *r.T, 0 * u, u, v, k], axis=-1),
    )
    from_csv = AirFlow.from_file(path, density=1.1)
    table = points(r, linear, k=k, dissipation=epsilon)
    table["x"].attrs["units"], table["k"].attrs["units"] = "m", "m2/s2"
    table.to_netcdf(tmp_path / "export.nc", engine="h5netcdf")
    from_netcdf = AirFlow.from_file(tmp_path / "export.nc")
    for air in (from_csv, from_netcdf):
        np.testing.assert_allclose(air.at(INSIDE, 0.0), linear(INSIDE), rtol=1e-12)
        found = air.turbulence_at(INSIDE, 0.0)
        np.testing.assert_allclose(found[0], 1 + INSIDE[:, 0], rtol=1e-12)
        np.testing.assert_allclose(found[1], 5 + INSIDE[:, 2], rtol=1e-12)
    assert from_csv.density == 1.1
    with pytest.raises(fp.FlowRangeError, match="outside of the table of the flow"):
        from_csv.turbulence_at(INSIDE + 1.0, 0.0)


HEADING = "x [m],y [m],z [m],u [m/s],v [m/s],w [m/s]"


@pytest.mark.parametrize(
    ("heading", "message"),
    [
        ("1.0,2.0,3.0,4,5 6,6", "`path` must begin with a heading such as"),
        (HEADING.replace("x [m]", "x [mm]"), "`x` of the table must be in m, got mm"),
        (HEADING.replace("u [m/s]", "u [km/h]"), "`velocity_x` of the table must be"),
        (HEADING.replace("w [m/s]", "u"), "`path` must have every column once"),
        (HEADING.replace("w [m/s]", "p"), "`table` must have .*without velocity_z"),
        (HEADING.replace("y [m],z [m]", "a,b"), "without y, z; one coordinate may be"),
        (HEADING + ",k", "`path` must have 7 numbers a line, got 6"),
    ],
)
def test_a_file_with_another_heading_is_refused(heading, message, tmp_path):
    path = exported(tmp_path / "export.csv", heading, RNG.random((9, 6)))
    with pytest.raises(ValueError, match=message):
        AirFlow.from_file(path)


FLAT = scattered(9) * [1.0, 1.0, 0.0]


@pytest.mark.parametrize(
    ("table", "message"),
    [
        (points(scattered(9), linear, k=np.ones(17)), "both of k and dissipation"),
        (
            points(scattered(9), linear, k=-np.ones(17), dissipation=np.ones(17)),
            "`table` must have a non-negative k, got -1",
        ),
        (points(scattered(9)[[0, *range(17)]], linear), "every point once, got 1"),
        (points(FLAT, linear), "must have points that span x, y, z"),
        (
            points(scattered(9) * [1, 1, np.nan], linear),
            "finite numbers as coordinates",
        ),
        (points(scattered(9), lambda r: linear(r) * np.nan), "numbers as velocity"),
        (
            grid(3, linear).rename_dims(z="a"),
            "as the coordinates of a grid, or all of them",
        ),
    ],
)
def test_what_is_no_table_of_a_flow_is_refused(table, message):
    with pytest.raises(ValueError, match=message):
        AirFlow.from_dataset(table)


def test_too_few_points_have_no_error():
    assert AirFlow.from_dataset(grid(2, linear)).table_errors()["velocity"] == np.inf
    corners = AirFlow.from_dataset(points(scattered(0), linear))
    assert corners.table_errors()["velocity"] == np.inf


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"k": -1.0, "dissipation": 1.0}, "`k` must be non-negative"),
        ({"k": 1.0}, "`dissipation` must be given with `k`"),
        ({"k": np.nan, "dissipation": 1.0}, "`k` must be"),
    ],
)
def test_turbulence_that_is_none_is_refused(options, message):
    with pytest.raises(ValueError, match=message):
        AirFlow((1.0, 0.0, 0.0), **options)


@pytest.mark.parametrize(
    ("k", "dissipation", "message"),
    [
        (lambda r, t: r, 1.0, r"`k` must return finite numbers of the shape \(200,\)"),
        (
            lambda r, t: -r[:, 0],
            1.0,
            "must be non-negative, and `dissipation` positive",
        ),
        (1.0, lambda r, t: 0 * r[:, 0], "`dissipation` positive where `k` is"),
    ],
)
def test_functions_that_are_no_turbulence_are_refused(k, dissipation, message):
    air = AirFlow((1.0, 0.0, 0.0), k=k, dissipation=dissipation)
    with pytest.raises(ValueError, match=message):
        air.turbulence_at(INSIDE, 0.0)
