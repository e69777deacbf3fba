"""The parts of `steady_state`: strides, corrections, coarser grids, error estimates."""

__all__: list[str] = []
