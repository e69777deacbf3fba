"""How fast and how wide nozzles should move, so that a web laid in phase is even.

`design_nozzles` scans the pattern that they lay on average, and searches its valleys.
The names are loaded from their modules.
"""
