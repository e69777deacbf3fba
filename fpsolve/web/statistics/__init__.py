"""How even a web is: numbers with standard errors from independent blocks of it.

All functions take plain arrays, `length_density[cross direction, machine direction]`
in laid length per area, or whatever else is proportional to mass per area.
"""
