r"""
Orbits without noise (figure 6)
===============================

Without noise and belt speed the fibre moves in :math:`(r, \beta)`, the distance from
the nozzle and the angle to the radius, on level sets of

.. math::

   E(r, \beta) = B(r) - \ln r - \ln\sin\beta ,

equation (14) of the paper.
"""

import numpy as np

import fpsolve as fp

# The orbits do not depend on the noise.
process = fp.EnergyProcess(fp.QuadraticPotential(), noise=1.0)
figure = fp.plotting.plot_orbits(process)

# %%
# The same for :math:`B = \|\xi\|`, whose orbits reach farther out:

linear = fp.EnergyProcess(fp.LinearPotential(), noise=1.0)
second_figure = fp.plotting.plot_orbits(linear)

# %%
# **What is seen.** Left: closed orbits about the fixed point :math:`(r, \beta) = (1,
# \pi/2)`. Right: the fibres of three of them. The fixed point is a circle; the others
# are rosettes between two circles.
#
# **Compared with the paper.** The left half is figure 6. It labels orbits by
# :math:`E`, here by :math:`G = e^{-E}`; where the paper lets :math:`e` start at 0,
# the least energy is :math:`B(1)` (:doc:`/misprints`). A path of the full model
# without noise keeps :math:`G`:

still = fp.LayDownModel(fp.QuadraticPotential(), noise=0.0)
path = fp.sample_paths(
    still, 1, s_end=50.0, ds=0.01, seed=1, initial=((1.2, 0.0), 1.9)
).replay(0)
energy = process.energy(*path.xi.T, path.alpha)
print(f"G = {energy[0]:.6f}, changes along 50 units of fibre by {np.ptp(energy):.0e}")
print(f"period of that orbit {float(process.period(energy[0])):.4f}")

# %%
# **Cost.** A second. Periods, variances and the process of :math:`G` with noise are
# on :doc:`/energy`.
