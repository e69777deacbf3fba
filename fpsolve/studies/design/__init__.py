"""Which process lays the most even web, or meets a bound at the least cost.

`design_web` minimises the predicted variation at fixed base weight, and lays the web of
its optimum. The names are loaded from their modules.
"""
