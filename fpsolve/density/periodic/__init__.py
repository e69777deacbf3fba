"""The parts of `periodic_state`: the period, its phases, coarser grids, the result."""

__all__: list[str] = []
