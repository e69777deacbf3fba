r"""
Much noise: a belt shifts the web
=================================

With much noise the angle can be dropped: what is left is diffusion in the plane,
remark 3.7 of the paper. The stationary density on a moving belt is the Gaussian of the
belt at rest, moved downstream by :math:`A^2v`.
"""

import numpy as np
from matplotlib.figure import Figure

import fpsolve as fp

model = fp.LayDownModel(fp.QuadraticPotential(), noise=3.0, curve=fp.MovingBelt(0.1))
limit = fp.HydrodynamicLimit(model)
grid = fp.PhaseSpaceGrid(half_width=5.0, shape=(48, 48, 16))
full = fp.spectral_steady_state(model, tolerance=1e-6)
marginal = full.density(grid).sum(axis=2) * grid.spacing[2]
limit_density = limit.equilibrium(*grid.plane())

figure = Figure(figsize=(7.0, 3.2), layout="constrained")
panels = figure.subplots(1, 2, sharex=True, sharey=True)
for axes, density, title in (
    (panels[0], marginal, "full equation, ∫ p dα"),
    (panels[1], limit_density, "large-noise limit"),
):
    image = axes.pcolormesh(grid.xi1, grid.xi2, density.T, vmin=0.0, vmax=0.16)
    axes.set(title=title, xlabel=r"$\xi_1$", aspect="equal")
    axes.plot(3.0**2 * 0.1, 0.0, "w+")
panels[0].set_ylabel(r"$\xi_2$")
bar = figure.colorbar(image, ax=panels, label="density")

# %%
print(f"A²v = {3.0**2 * 0.1:.3f}")
print(f"mean of the full equation {full.moments['mean_xi1']:.3f}")
difference = np.abs(marginal - limit_density).sum() * grid.spacing[0] * grid.spacing[1]
print(f"L1 difference of the two densities {difference:.3f}")

# %%
# **What is seen.** At :math:`A = 3` the two are the same to the eye; the cross is
# :math:`(A^2v, 0)`.
#
# **Compared with the paper.** The paper prints the stationary density with the belt
# pushing upstream, and the mean of remark 3.7 downstream; downstream is right
# (:doc:`/misprints`).
#
# **Cost.** A second. Orders of convergence are on :doc:`/limits`.
