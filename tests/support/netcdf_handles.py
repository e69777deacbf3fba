"""Variables of netCDF files, each looked up once for as long as its file is open."""

from functools import wraps

from h5netcdf import core, dimensions

__all__ = ["look_up_each_once"]


def look_up_each_once():
    """Let variables and dimensions of h5netcdf keep their HDF5 dataset.

    They look it up in the file for every shape, type and attribute, some thirty times
    each: half of the time that a result takes to be written or read. A path leads to
    the same dataset always, but for a dimension that becomes a variable: it leaves the
    dataset that it had, and that is let go. Files are the same, byte for byte.
    """
    for one in (core.BaseObject, dimensions.Dimension):
        one._h5ds = property(kept(one._h5ds.fget))
    dimensions.Dimension._detach_scale = let_go(dimensions.Dimension._detach_scale)


def kept(look_up):
    def dataset(owner):
        if "_kept_dataset" not in vars(owner):
            owner._kept_dataset = look_up(owner)
        return owner._kept_dataset

    return dataset


def let_go(leave):
    @wraps(leave)
    def left(dimension):
        leave(dimension)
        vars(dimension).pop("_kept_dataset", None)

    return left
