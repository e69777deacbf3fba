"""Paths survive a file bit for bit, and go on from it as if never stored."""

import json
from dataclasses import fields, replace

import numpy as np
import pytest
import xarray as xr
from solutions import relaxing_solution

import fpsolve as fp
from fpsolve.errors import FileFormatError
from fpsolve.paths import DensityLaw, EquilibriumLaw, GaussianLaw, PointLaw
from fpsolve.paths.ensemble import Ensemble

SUFFIXES = [".nc", ".zarr"]
ARRAYS = ("s", "states", "sums", "counts", "outside", "start", "end")
GRID = fp.PhaseSpaceGrid((5.0, 6.0), (6, 8, 4))
MODEL = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.RotatingNozzle(0.1, 1.0, 0.7))


def sampled(model=MODEL, **options):
    """A few paths, saved at both ends and between."""
    chosen = {
        "seed": 7,
        "save_at": (0.0, 0.5, 1.0),
        "initial": GaussianLaw(),
        **options,
    }
    return fp.sample_paths(model, 9, 1.0, 0.125, **chosen)


@pytest.fixture(scope="module")
def paths():
    return sampled(histogram=GRID)


@pytest.fixture(scope="module")
def content(paths, tmp_path_factory):
    """The bytes of their file."""
    return paths.save(tmp_path_factory.mktemp("paths") / "paths.nc").read_bytes()


def same_bits(first, second):
    return (
        first.dtype == second.dtype
        and first.shape == second.shape
        and first.tobytes() == second.tobytes()
    )


def assert_same(first, second):
    for name in ARRAYS:
        assert same_bits(getattr(first, name), getattr(second, name)), name
    for name in ("status", "message", "provenance"):
        assert getattr(first, name) == getattr(second, name), name
    for field in fields(Ensemble):
        if field.name != "law":
            one, other = (getattr(p.ensemble, field.name) for p in (first, second))
            assert one == other, field.name


@pytest.mark.parametrize("suffix", SUFFIXES)
@pytest.mark.parametrize(
    "options",
    [
        {},
        {"histogram": GRID},
        {"keep": False},
        {"keep": False, "histogram": GRID},
        {"method": "heun", "s_start": -0.5, "save_at": (0.25, 1.0)},
    ],
    ids=["kept", "counted", "moments", "counted only", "another method"],
)
def test_paths_come_back_bit_for_bit(tmp_path, suffix, options):
    paths = sampled(**options)
    path = tmp_path / f"paths{suffix}"
    assert paths.save(path) == path
    loaded = fp.load(path)
    assert_same(loaded, paths)
    assert loaded.initial == paths.initial


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_stored_paths_go_on_bitwise_as_if_never_stored(paths, tmp_path, suffix):
    loaded = fp.load(paths.save(tmp_path / f"paths{suffix}"))
    uninterrupted = fp.sample_paths(MODEL, 9, 2.0, 0.125, seed=7, initial=GaussianLaw())
    on = loaded.continued(2.0)
    assert same_bits(on.states, uninterrupted.states)
    # And once more through a file, from where they have got to.
    again = fp.load(on.save(tmp_path / f"on{suffix}"))
    assert_same(again, on)
    assert same_bits(again.continued(3.0).states, on.continued(3.0).states)


@pytest.mark.parametrize("keep", [True, False])
def test_a_stored_path_is_replayed_bitwise(tmp_path, keep):
    paths = sampled(keep=keep)
    loaded = fp.load(paths.save(tmp_path / "paths.nc"))
    before, after = paths.replay(3), loaded.replay(3)
    assert same_bits(before.xi, after.xi)
    assert same_bits(before.alpha, after.alpha)
    assert same_bits(before.eta, after.eta)


def density_law():
    p = fp.initial.gaussian(GRID, (0.5, 0.0), variance=3.0)
    return DensityLaw(GRID, p)


@pytest.mark.parametrize(
    "initial",
    [
        PointLaw(),
        PointLaw((1.0, -2.0), 0.5),
        GaussianLaw((1.0, 0.0), ((1.0, 0.25), (0.25, 0.5)), 1.5, 4.0),
        EquilibriumLaw(fp.QuadraticPotential(1.0, 0.5)),
        density_law(),
        (np.linspace(-1, 1, 18).reshape(9, 2), np.linspace(0, 7, 9)),
    ],
    ids=["point", "directed", "gaussian", "equilibrium", "density", "given"],
)
def test_every_start_can_be_drawn_again(tmp_path, initial):
    # Without positions the law alone says where a path starts.
    paths = sampled(initial=initial, keep=False)
    loaded = fp.load(paths.save(tmp_path / "paths.nc"))
    assert same_bits(loaded.replay(8).xi, paths.replay(8).xi)
    assert same_bits(loaded.replay(8).alpha, paths.replay(8).alpha)


class Ring:
    """A user's own law: uniform on the unit circle, going round."""

    def sample(self, rng, n):
        phi = rng.uniform(0, 2 * np.pi, n)
        return np.stack([np.cos(phi), np.sin(phi)], axis=-1), phi + np.pi / 2

    def __repr__(self):
        return "Ring()"


def test_a_law_of_the_user_leaves_its_description(tmp_path):
    paths = sampled(initial=Ring())
    paths.save(tmp_path / "first.nc")
    with pytest.warns(UserWarning, match=r"so `initial` is None: Ring\(\) is a user's"):
        loaded = fp.load(tmp_path / "first.nc")
    assert loaded.initial is None
    described = dict(loaded.provenance["initial_description"])
    assert len(described.pop("sampled")) == 64
    assert described == {"kind": "custom", "description": "Ring()"}
    # The starts themselves are in the file.
    assert same_bits(loaded.replay(2).xi, paths.replay(2).xi)
    # The description goes on when the paths are stored again.
    loaded.save(tmp_path / "second.nc")
    with pytest.warns(UserWarning, match=r"Ring\(\) is a user's own law\."):
        again = fp.load(tmp_path / "second.nc")
    assert again.provenance == loaded.provenance


class Turned(fp.paths.PointLaw):
    """A user's law that is derived from one of ours."""

    def sample(self, rng, n):
        xi, alpha = super().sample(rng, n)
        return -xi, alpha


def test_a_law_derived_from_one_of_ours_is_not_read_back_as_that(tmp_path):
    paths = sampled(initial=Turned((1.0, 0.0), 0.5))
    paths.save(tmp_path / "turned.nc")
    with pytest.warns(UserWarning, match="`initial` is None"):
        assert fp.load(tmp_path / "turned.nc").initial is None


def test_paths_without_positions_and_law_are_not_replayed(tmp_path):
    sampled(initial=Ring(), keep=False).save(tmp_path / "gone.nc")
    with pytest.warns(UserWarning, match="`initial` is None"):
        loaded = fp.load(tmp_path / "gone.nc")
    with pytest.raises(ValueError, match="the law of the start must be known for this"):
        loaded.replay(2)


def square(xi1, xi2):
    return 0.5 * (xi1**2 + xi2**2)


def test_a_model_of_functions_leaves_its_description_and_moments(tmp_path):
    potential = fp.CallablePotential(square, lambda xi1, xi2: (xi1, xi2))
    paths = sampled(fp.LayDownModel(potential, 1.0))
    paths.save(tmp_path / "first.nc")
    with pytest.warns(UserWarning, match=r"could not be read back, so `model` is None"):
        loaded = fp.load(tmp_path / "first.nc")
    assert loaded.model is None
    assert loaded.provenance["equation"] == paths.model.process_equation
    assert same_bits(loaded.states, paths.states)
    assert same_bits(
        loaded.moments().values["mean_xi1"], paths.moments().values["mean_xi1"]
    )


def test_a_seed_longer_than_any_integer_of_a_file_survives(paths, tmp_path):
    seed = 2**127 + 1
    long = replace(paths, ensemble=replace(paths.ensemble, seed=seed))
    assert fp.load(long.save(tmp_path / "paths.nc")).seed == seed


def test_unfinished_paths_stay_unfinished(paths, tmp_path):
    part = replace(paths, status="interrupted", message="stopped by the user")
    assert_same(fp.load(part.save(tmp_path / "paths.nc")), part)


def test_the_dataset_is_labelled(paths):
    dataset = paths.to_xarray()
    assert dataset["xi"].dims == ("s", "path", "component")
    assert dataset["alpha"].dims == ("s", "path")
    assert dataset["counts"].dims == ("s", "cell_xi1", "cell_xi2", "cell_alpha")
    assert dataset["mean_square_standard_error"].dims == ("s",)
    np.testing.assert_array_equal(dataset["xi"], paths.xi)
    np.testing.assert_array_equal(dataset["alpha"], paths.alpha)
    np.testing.assert_array_equal(dataset["s"], paths.s)
    np.testing.assert_array_equal(dataset["cell_xi2"], GRID.xi2)
    np.testing.assert_array_equal(dataset["component"], [1, 2])
    for name, variable in dataset.variables.items():
        assert variable.attrs["units"] == "1", name
        assert len(variable.attrs["long_name"]) > 5, name


def test_the_dataset_holds_the_moments_with_their_errors(paths):
    dataset, moments = paths.to_xarray(), paths.moments()
    for name in moments:
        value, error = moments[name]
        np.testing.assert_array_equal(dataset[name], value)
        np.testing.assert_array_equal(dataset[f"{name}_standard_error"], error)


def test_the_dataset_says_how_to_repeat_the_paths(paths):
    attributes = paths.to_xarray().attrs
    again = fp.sample_paths(
        fp.LayDownModel.from_dict(json.loads(attributes["model"])),
        attributes["n_paths"],
        attributes["s_start"] + attributes["n_steps"] * attributes["ds"],
        attributes["ds"],
        seed=int(attributes["seed"]),
        method=attributes["method"],
        initial=GaussianLaw(),
        save_at=paths.s,
    )
    assert same_bits(again.states, paths.states)
    assert json.loads(attributes["initial"]) == GaussianLaw().to_dict()
    assert attributes["equation"] == MODEL.process_equation
    assert attributes["numpy_version"] == np.__version__
    assert attributes["date_created"] == paths.provenance["date"]
    assert attributes["Conventions"].startswith("CF-")
    assert attributes["fpsolve_kind"] == "paths"


def test_paths_that_were_not_kept_have_no_positions():
    dataset = sampled(keep=False).to_xarray()
    assert "path" not in dataset.dims
    assert "xi" not in dataset
    assert "counts" not in dataset


@pytest.mark.parametrize(
    ("curve", "noise", "equation"),
    [
        (fp.FixedBelt(), 0.0, "dξ = τ(α) ds, dα = -∇B(ξ)·τ⊥(α) ds, B = "),
        (fp.MovingBelt(0.1), 2.0, "dξ = (τ(α) + 0.1 e₁) ds, dα = "),
        (fp.MovingBelt(-0.1), 2.0, "dξ = (τ(α) - 0.1 e₁) ds, dα = "),
        (fp.OscillatingNozzle(0.1, 1.0, 2.0), 1.0, "dξ = τ(α) ds - dγ, dα = "),
    ],
)
def test_the_equation_names_what_drives_a_path(curve, noise, equation):
    model = fp.LayDownModel(fp.QuadraticPotential(), noise, curve)
    text = model.process_equation
    assert text.startswith(equation)
    assert ("dW" in text) == (noise > 0)
    assert ("γ(s) = " in text) == (not curve.autonomous)


def test_other_programs_read_the_file(paths, content, tmp_path):
    path = tmp_path / "paths.nc"
    path.write_bytes(content)
    with xr.open_dataset(path, engine="h5netcdf") as dataset:
        xi = dataset["xi"].sel(s=0.5, component=2)
        np.testing.assert_array_equal(xi, paths.xi[1, :, 1])


def test_what_a_file_holds_decides_what_is_loaded(content, tmp_path):
    relaxing_solution(errors=False).save(tmp_path / "result.nc")
    assert isinstance(fp.load(tmp_path / "result.nc"), fp.Solution)
    (tmp_path / "result.nc").write_bytes(content)
    assert isinstance(fp.load(tmp_path / "result.nc"), fp.Paths)


def test_a_kind_from_the_future_is_refused(paths, tmp_path):
    dataset = paths.to_xarray().assign_attrs(fpsolve_kind="string")
    dataset.to_netcdf(tmp_path / "string.nc", engine="h5netcdf")
    message = r"it holds 'string', this version of fpsolve reads 'solution', 'paths', "
    with pytest.raises(FileFormatError, match=message):
        fp.load(tmp_path / "string.nc")


def test_missing_parts_are_named(paths, tmp_path):
    dataset = paths.to_xarray().drop_vars("moment_sums")
    del dataset.attrs["seed"]
    dataset.to_netcdf(tmp_path / "paths.nc", engine="h5netcdf")
    with pytest.raises(
        FileFormatError, match=r"`moment_sums`, `seed` is missing in it\."
    ):
        fp.load(tmp_path / "paths.nc")
    for name in ("end_turns", "counts"):
        dataset = paths.to_xarray().drop_vars(name)
        dataset.to_netcdf(tmp_path / "paths.nc", engine="h5netcdf")
        with pytest.raises(FileFormatError, match=f"`{name}` is missing in it"):
            fp.load(tmp_path / "paths.nc")


@pytest.mark.parametrize("share", [0.0, 0.001, 0.1, 0.5, 0.999])
def test_a_truncated_file_is_refused(content, tmp_path, share):
    path = tmp_path / "paths.nc"
    path.write_bytes(content[: int(share * len(content))])
    with pytest.raises(FileFormatError, match=r"cannot read `.*paths\.nc`: "):
        fp.load(path)


def test_a_description_that_is_damaged_is_refused(paths, tmp_path):
    dataset = paths.to_xarray().assign_attrs(initial='{"kind": "gau')
    dataset.to_netcdf(tmp_path / "paths.nc", engine="h5netcdf")
    with pytest.raises(FileFormatError, match=r"cannot read `.*paths\.nc`: "):
        fp.load(tmp_path / "paths.nc")


def test_a_failed_write_leaves_the_old_file_and_nothing_else(
    paths, content, tmp_path, monkeypatch
):
    path = tmp_path / "paths.nc"
    path.write_bytes(content)

    def full(dataset, draft, **options):
        draft.write_bytes(b"half")
        raise OSError("no space left on device")

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    with pytest.raises(OSError, match="no space left"):
        replace(paths, message="new").save(path)
    assert list(tmp_path.iterdir()) == [path]
    assert path.read_bytes() == content


def test_histograms_of_many_empty_cells_take_little_room(tmp_path):
    grid = fp.PhaseSpaceGrid(6.0, (32, 32, 32))
    paths = sampled(histogram=grid, keep=False)
    path = paths.save(tmp_path / "paths.nc")
    # 27 counts among 98 304 cells of eight bytes, and 60 KiB of everything else.
    assert paths.counts.nbytes > 7e5
    assert path.stat().st_size < 1e5
