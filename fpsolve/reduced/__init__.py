"""The two limits of the Fokker-Planck equation: little noise and much noise.

Both are answers to the same question that share no code with the solver of the full
equation, and are what it is held against.
"""
