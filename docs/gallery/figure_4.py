r"""
What noise does to a fibre (figure 4)
=====================================

Six fibres of the same length and start on a belt at rest, :math:`B = \|\xi\|^2/2`, for
the noises of the paper, :math:`A = 0,\ 0.1,\ 1,\ 2,\ 5,\ 10`.
"""

import fpsolve as fp

noises = (0.0, 0.1, 1.0, 2.0, 5.0, 10.0)
fibres = [
    fp.sample_paths(
        fp.LayDownModel(fp.QuadraticPotential(), noise),
        n_paths=1, s_end=100.0, ds=0.02, seed=4, initial=((1.2, 0.0), 1.9),
    )
    for noise in noises
]  # fmt: skip
figure = fp.plotting.plot_trajectories(fibres)

# %%
# **What is seen.** Without noise the fibre stays on its orbit: a rosette between two
# circles, for ever. With :math:`A = 0.1` it drifts from orbit to orbit. At :math:`A =
# 1` and :math:`2` it fills the disc in which the stationary law has 95 % of its mass
# (dashed). With more noise it curls up and hardly leaves its place: after the same
# length a large part of the disc is still empty.
#
# **Compared with the paper.** The same six pictures; start and noise of each fibre
# are not given there, so that they agree in kind, not line by line.
#
# The paper concludes that convergence takes longest for very small and very large
# noise. In numbers: how far is the average of :math:`\|\xi\|^2` along a fibre of this
# length from its stationary value 2, in the root mean square over 2000 fibres?

for noise in noises[1:]:
    many = fp.sample_paths(
        fp.LayDownModel(fp.QuadraticPotential(), noise),
        n_paths=2000, s_end=100.0, ds=0.05, seed=4, initial=((1.2, 0.0), 1.9),
    )  # fmt: skip
    averages = many.time_averages(lambda xi1, xi2, alpha: xi1**2 + xi2**2)[-1]
    error = ((averages - 2.0) ** 2).mean() ** 0.5
    print(f"A = {noise:4}: {error:.2f}")

# %%
# **Cost.** A few seconds, most of it for the averages over 20 million steps. See
# :doc:`/paths` for averages along a fibre against theorem 3.3.
