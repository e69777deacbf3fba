"""Variables of netCDF files, each looked up once for as long as its file is open."""

from h5netcdf import core, dimensions

__all__ = ["look_up_each_once"]


def look_up_each_once():
    """Let variables and dimensions of h5netcdf keep their HDF5 dataset while reading.

    They look it up in the file for every shape, type and attribute, some thirty times
    each: more than half of the time that a result takes to be read. In a file that is
    only read a path leads to the same dataset always.
    """
    for one in (core.BaseObject, dimensions.Dimension):
        one._h5ds = property(kept(one._h5ds.fget))


def kept(look_up):
    def dataset(found):
        if "_kept_dataset" in vars(found):
            return found._kept_dataset
        looked_up = look_up(found)
        if found._root.mode == "r":
            found._kept_dataset = looked_up
        return looked_up

    return dataset
