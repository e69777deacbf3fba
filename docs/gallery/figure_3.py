r"""
Fibres under nozzles (figure 3)
===============================

Figure 3 of the paper shows fibres :math:`\eta` on the belt for a transversal and a
rotating spinning process, simulated by its string model. Here the lay-down model (6)
draws them, with an oscillating nozzle besides: the same noise and potential, and three
reference curves :math:`\gamma`.
"""

import fpsolve as fp

curves = (
    fp.MovingBelt(speed=0.1),
    fp.RotatingNozzle(speed=0.1, radius=2.0, angular_speed=0.2),
    fp.OscillatingNozzle(speed=0.1, amplitude=2.0, angular_speed=0.2),
)
fibres = [
    fp.sample_paths(
        fp.LayDownModel(fp.QuadraticPotential(), noise=1.0, curve=curve),
        n_paths=1, s_end=150.0, ds=0.02, seed=3,
    )
    for curve in curves
]  # fmt: skip
figure = fp.plotting.plot_nozzles(fibres)

# %%
# **What is seen.** A fibre stays within about two throwing ranges of its curve. On
# the transversal process its mass lies along a line; a moving nozzle spreads it over
# the width of its motion, and the loops of the fibre hide the cycloid.
#
# **Compared with the paper.** Figure 3 and the left column of figure 8 show the same
# shapes. Theirs have units of length; here one is the throwing range.
#
# How far the fibre is from its curve does not depend on the shape of the latter much:

for fibre, curve in zip(fibres, curves, strict=True):
    xi = fibre.replay(0).xi
    distance = (xi**2).sum(axis=-1).mean() ** 0.5
    print(f"{type(curve).__name__:18} root mean square distance {distance:.2f}")

# %%
# **Cost.** Below a second: three paths of 7500 steps. :doc:`/paths` tells how they
# are made and repeated.
