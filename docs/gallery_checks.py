"""What a script of the gallery may not leave: empty figures, studies with gaps."""

import xarray as xr


def check_drawn(figure):
    """Raise if there is nothing in a figure."""
    if not any(axes.has_data() for axes in figure.axes):
        raise ValueError("a figure of the gallery is empty")


def check_finished(names):
    """Raise if a study went on without one of its cases; a page may not show that."""
    for name, study in names.items():
        if isinstance(study, xr.Dataset) and "status" in study:
            statuses = set(study["status"].values.ravel())
            if statuses != {"finished"}:
                raise ValueError(f"`{name}` holds cases that are {statuses}")
