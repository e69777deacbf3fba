r"""
Fibres of the string and of its models (figures 8 and 9)
========================================================

The paper compares fibres :math:`\eta` that its string lays down with those of the basic
and the smooth model which are identified from them, for a nozzle at rest and one that
goes around. Here is the same with the string of :doc:`/string` in turbulent air.
"""

import fpsolve as fp
from fpsolve import fibre


def identified(radius, angular_speed):
    """Three metres of the string, as both models have them."""
    nozzle = fibre.Nozzle(
        (0, 0, 0.3), (0.1, 0.03, -1), 1.0, radii=(radius, radius),
        angular_speed=angular_speed,
    )  # fmt: skip
    string = fibre.String(0.2, 2e-4, 1000.0, 1e8, nozzle, fibre.Free(), n_edges=40)
    laid = fibre.lay_down(
        string, t_end=3.7, n_steps=1850, belt=fibre.Belt(0.1), seed=1,
        air=fibre.AirFlow((0, 0, -1.5), k=0.3, dissipation=5.0),
        turbulence=fibre.TurbulentForce(), estimate_error=False,
    )  # fmt: skip
    curve = laid.laid_curve(skip=0.5)
    return [fp.identify(curve, model=model) for model in ("smooth", "basic")]


transversal = identified(0.0, 0.0)
transversal_fibres = fp.plotting.plot_identified_fibres(*transversal)

# %%
# A nozzle that goes around in a circle of 5 cm, once in three seconds:

rotating = identified(0.05, 2.0)
rotating_fibres = fp.plotting.plot_identified_fibres(*rotating)

# %%
# Increments of angle and curvature of the first fibre, figure 9, with bands that hold
# 95 % of the fibres of a model:

increments = fp.plotting.plot_increments(*transversal)

# %%
for name, models in (("transversal", transversal), ("rotating", rotating)):
    for found in models:
        along, across, noise, *_ = found.parameters.values()
        print(
            f"{name:11} {type(found.model).__name__:18} "
            f"{1e3 * along:.1f} and {1e3 * across:.1f} mm, A = {noise:.2f}, p-values: "
            f"law of ξ₂ {found.p_values['law of xi2']:.3f}, "
            f"angle increments {found.p_values['angle increments']:.3f}"
        )

# %%
# **What is seen.** Fibres of both models fill the same strip of the belt with loops of
# the same size. The string's loops keep their sense of turning for longer:
# :math:`\Gamma_\alpha` of the string rises above both models.
#
# **Compared with the paper.** Theirs agree at the maximum of :math:`\Gamma_\alpha`, as
# the functional (24) makes it; here parameters are the most likely ones, which first of
# all fit the turns from chord to chord. :doc:`/string_to_web` says what p-values mean.
#
# **Cost.** About 15 s of CPU time, nearly all of it for the string.
