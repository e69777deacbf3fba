"""The map of the package, drawn from its imports when the pages are built."""

import ast
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "fpsolve"
OUT = Path(__file__).parent / "house"


def draw(app=None):
    """Write the map and the table of rooms into a folder beside this file."""
    known = knowledge()
    OUT.mkdir(exist_ok=True)
    (OUT / "rooms.md").write_text(table(known), "utf-8")
    picture(known).savefig(OUT / "house.svg", bbox_inches="tight", transparent=True)


def knowledge():
    """Every room with the rooms that its files import, wherever the import stands."""
    rooms = {path.parent.name for path in PACKAGE.glob("*/__init__.py")}
    return {room: imported(PACKAGE / room) & rooms - {room} for room in rooms}


def imported(folder):
    """The first names below `fpsolve` in all imports of the files of a folder."""
    nodes = (
        node
        for path in folder.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.ImportFrom)
    )
    names = (f"{node.module}.{node.names[0].name}".split(".") for node in nodes)
    return {parts[1] for parts in names if parts[0] == "fpsolve"}


def floors(known):
    """The rooms by floor: each stands on the highest one that it knows."""
    height = {}
    while len(height) < len(known):
        placed = height.keys()
        free = [one for one in known if one not in placed and known[one] <= placed]
        height |= {
            room: 1 + max((height[one] for one in known[room]), default=-1)
            for room in free
        }
    levels = [[] for _ in range(1 + max(height.values()))]
    for room in sorted(known):
        levels[height[room]].append(room)
    return levels


def needed(known):
    """The arrows that say all: none that two others make."""
    reach = {room: set(below) for room, below in known.items()}
    for level in floors(known):
        for room in level:
            reach[room] |= set().union(*(reach[one] for one in reach[room]))
    return [
        (room, one)
        for room, below in known.items()
        for one in below
        if not any(one in reach[other] for other in below)
    ]


def table(known):
    """The rooms from the top, what is in each, and what it may know, for the page."""
    lines = ["| room | holds | knows |", "| --- | --- | --- |"]
    order = [one for level in floors(known) for one in level]
    for level in reversed(floors(known)):
        for room in level:
            first = ast.get_docstring(
                ast.parse((PACKAGE / room / "__init__.py").read_text("utf-8"))
            ).splitlines()[0]
            below = [one for one in order if one in known[room]]
            lines.append(f"| `{room}` | {first} | {', '.join(below) or 'nothing'} |")
    return "\n".join(lines) + "\n"


def picture(known):
    """One box for every room, in the order of the floors."""
    from matplotlib.figure import Figure

    figure = Figure((8.0, 7.5))
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    place = {}
    for y, level in enumerate(floors(known)):
        for x, room in enumerate(level):
            place[room] = (2.2 * (x - (len(level) - 1) / 2), y)
    for above, below in needed(known):
        (x1, y1), (x2, y2) = place[above], place[below]
        axes.annotate(
            "", (x2, y2 + 0.22), (x1, y1 - 0.22),
            arrowprops={"arrowstyle": "-|>", "color": "0.55", "lw": 0.9,
                        "shrinkA": 0, "shrinkB": 0},
        )  # fmt: skip
    for room, (x, y) in place.items():
        axes.text(
            x, y, room, ha="center", va="center", family="monospace",
            bbox={"boxstyle": "round,pad=0.45", "fc": "#eef3f8", "ec": "#345"},
        )  # fmt: skip
    widest = max(abs(x) for x, _ in place.values()) + 1.2
    axes.set_xlim(-widest, widest)
    axes.set_ylim(-0.6, len(floors(known)) - 0.4)
    return figure


if __name__ == "__main__":
    draw()
