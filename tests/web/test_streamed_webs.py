"""A web on a disk is the one in memory."""

import numpy as np
import pytest
import xarray as xr

import fpsolve as fp

BASIC = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.2))
PROCESS = fp.Process(5e-3, 5e-3, 15.0, 0.2, 20.0)
OPTIONS = {"width": 2.0, "length": 6.0, "spacing": 0.25, "pixel": 0.25, "seed": 11}
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


def test_what_cannot_be_streamed_is_refused(tmp_path):
    with pytest.raises(ValueError, match=r"`path` must end in \.zarr"):
        fp.stream_web(BASIC, tmp_path / "web.nc", **OPTIONS)
    with pytest.raises(ValueError, match="`tile` must be positive"):
        fp.stream_web(BASIC, tmp_path / "web.zarr", tile=0.0, **OPTIONS)
    with pytest.raises(TypeError, match="client"):
        fp.stream_web(BASIC, tmp_path / "web.zarr", client=3, **OPTIONS)
    assert list(tmp_path.iterdir()) == []
