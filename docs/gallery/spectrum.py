r"""
Decay rates against noise
=========================

The eigenvalues behind figure 5. The gap is the rate at which every average converges;
branches of several angular sectors cross, and the best noise is where a complex pair
merges on the real axis.
"""

import numpy as np

import fpsolve as fp

noises = np.geomspace(0.4, 5.0, 15).round(3)
study = fp.studies.rate_versus_noise(
    fp.QuadraticPotential(), noises, parts=("gap", "branches"), quick=True, workers=0
)
figure = fp.plotting.plot_rates(study)

# %%
best = fp.optimal_noise(fp.QuadraticPotential(), tolerance=1e-7)
print(f"best noise {best.noise:.6f}, gap {best.gap:.6f}: {best.kind}")

# %%
# **What is seen.** For little noise the gap is :math:`A^2/2` exactly, the rate at
# which a fibre forgets which way round it loops. For much noise it is about
# :math:`A^{-2}`, the diffusion of the fibre in the plane. The cusp between them is
# the noise at which a web becomes uniform fastest.
#
# **Compared with the paper.** Theorem 3.3 bounds the convergence by :math:`c_2/A +
# c_3A` and so predicts a best noise at a finite :math:`A`; this is where it is.
# Proven bounds of the rate are the shaded region.
#
# **Cost.** About 10 s of CPU time; no grid is involved. See :doc:`/rates`.
