"""A web on a disk is the one in memory."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import xarray as xr

import fpsolve as fp

BASIC = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.2))
PROCESS = fp.Process(5e-3, 5e-3, 15.0, 0.2, 20.0)
OPTIONS = {"width": 2.0, "length": 6.0, "spacing": 0.25, "pixel": 0.25, "seed": 11}
MOVING = {
    "rotating": fp.LayDownModel(
        fp.QuadraticPotential(), 1.0, fp.RotatingNozzle(0.2, 1.0, 0.5)
    ),
    "backwards": fp.SmoothLayDownModel(
        fp.QuadraticPotential(), 0.5, 1.0, fp.OscillatingNozzle(-0.2, 1.0, 0.5)
    ),
}
SI = {"width": 0.01, "length": 0.03, "spacing": 1e-3, "pixel": 1e-3, "seed": 3,
      "titer": 2e-4}  # fmt: skip


@pytest.mark.parametrize(("model", "options"), [(BASIC, OPTIONS), (PROCESS, SI)])
def test_a_streamed_web_is_the_saved_one_bit_for_bit(model, options, tmp_path):
    path = fp.stream_web(model, tmp_path / "web.zarr", **options)
    streamed, laid = fp.load(path), fp.lay_web(model, **options)
    comparison = fp.compare(streamed, laid)
    assert comparison.equal, str(comparison)
    assert not comparison.parameters
    for name in ("length_density", "orientation_11", "orientation_12"):
        np.testing.assert_array_equal(getattr(streamed, name), getattr(laid, name))
    # And it is repeated by its call, in memory.
    assert fp.compare(fp.rerun(path), laid).equal
    # Nothing else is left in the folder.
    assert [one.name for one in tmp_path.iterdir()] == ["web.zarr"]


def test_a_store_has_tiles_along_the_machine(tmp_path):
    path = fp.stream_web(BASIC, tmp_path / "web.zarr", tile=1.5, **OPTIONS)
    with xr.open_zarr(path, consolidated=False, chunks=None) as store:
        assert store["length_density"].encoding["chunks"] == (8, 6)
        assert store["orientation_12"].encoding["chunks"] == (8, 6)
        tile = store["length_density"].isel(machine=slice(6, 12)).to_numpy()
    whole = fp.lay_web(BASIC, **OPTIONS).length_density
    np.testing.assert_array_equal(tile, whole[:, 6:12])


@pytest.mark.parametrize("name", MOVING)
@pytest.mark.parametrize("tile", [0.25, 1.0, 100.0])
def test_a_web_laid_tile_by_tile_is_the_one_laid_at_once(name, tile, tmp_path):
    laid = fp.lay_web(MOVING[name], **OPTIONS)
    path = fp.stream_web(MOVING[name], tmp_path / "web.zarr", tile=tile, **OPTIONS)
    comparison = fp.compare(fp.load(path), laid)
    assert comparison.equal, str(comparison)


@pytest.mark.parametrize("name", ["rotating", "backwards"])
def test_tiles_laid_elsewhere_are_the_ones_laid_here(name, tmp_path, monkeypatch):
    monkeypatch.setattr("fpsolve.web.laying._ELSEWHERE", 7)
    options = {**OPTIONS, "tile": 1.0}
    here = fp.stream_web(MOVING[name], tmp_path / "here.zarr", **options)
    with ThreadPoolExecutor(2) as executor:
        there = fp.stream_web(
            MOVING[name], tmp_path / "there.zarr", client=executor, **options
        )
    comparison = fp.compare(fp.load(here), fp.load(there))
    assert comparison.equal, str(comparison)
    assert not comparison.parameters


def test_a_client_lays_a_web_across_which_it_comes_back(tmp_path, monkeypatch):
    monkeypatch.setattr("fpsolve.web.laying._ELSEWHERE", 3)
    options = {**OPTIONS, "periodic": True}
    with ThreadPoolExecutor(1) as executor:
        path = fp.stream_web(
            BASIC, tmp_path / "web.zarr", client=executor, tile=2.0, **options
        )
    assert fp.compare(fp.load(path), fp.lay_web(BASIC, **options)).equal


@pytest.mark.parametrize("length", [10.0, 40.0, 80.0])
def test_the_image_of_a_stretch_does_not_grow_with_the_web(length):
    from fpsolve.web.order import order_of
    from fpsolve.web.stretches import lay_in_stretches

    plan, told = order_of(BASIC, **OPTIONS | {"length": length}).plan, []
    parts = list(lay_in_stretches(plan, 2.0, None, lambda n, s: told.append(n)))
    # A tile in whole legs, as far as fibres are thrown, a leg and a pixel both ways.
    (low, high), _ = plan.margins.reach
    leg = 64 * plan.ensemble.schedule.ds
    most = (2.0 + 0.2 * leg + high - low + 2 * leg) / 0.25 + 4
    assert max(part.counts.shape[1] for part in parts) <= most < 40.0 / 0.25
    assert len(parts) > length / (2.0 + 0.2 * leg)
    # Every step of every fibre is told.
    assert sum(told) == plan.n_fibres * plan.ensemble.schedule.n_steps


# Libraries of dask warn about their own future and leave sockets to be collected.
@pytest.mark.processes
@pytest.mark.filterwarnings("ignore")
def test_a_dask_cluster_lays_the_same_webs(tmp_path, monkeypatch):
    import distributed

    monkeypatch.setattr("fpsolve.web.laying._ELSEWHERE", 7)
    options = {"processes": False, "dashboard_address": None, "n_workers": 2}
    with (
        distributed.LocalCluster(**options, threads_per_worker=1) as cluster,
        distributed.Client(cluster) as client,
    ):
        laid = fp.lay_web(MOVING["rotating"], client=client, **OPTIONS)
        path = fp.stream_web(
            MOVING["rotating"], tmp_path / "web.zarr", client=client, tile=1.5,
            **OPTIONS,
        )  # fmt: skip
    here = fp.lay_web(MOVING["rotating"], **OPTIONS)
    assert fp.compare(laid, here).equal
    assert fp.compare(fp.load(path), here).equal


def test_what_cannot_be_streamed_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"`path` must end in \.zarr"):
        fp.stream_web(BASIC, tmp_path / "web.nc", **OPTIONS)
    with pytest.raises(ValueError, match="`tile` must be positive"):
        fp.stream_web(BASIC, tmp_path / "web.zarr", tile=0.0, **OPTIONS)
    with pytest.raises(TypeError, match="client"):
        fp.stream_web(BASIC, tmp_path / "web.zarr", client=3, **OPTIONS)
    assert list(tmp_path.iterdir()) == []
