r"""
Webs of little and much noise (figure 10)
=========================================

Fibres of the smooth model on a moving belt,

.. math::

   \eta_f(s) = \xi_f(s) - v s\, e_1 + y_f\, e_2 , \qquad
   d\xi = (\tau(\alpha) + v e_1)\,ds ,

spun from a row of nozzles at distance :math:`d`, with
:math:`\sigma_1 = \sigma_2 = R = 1` and :math:`v = 0.1` as in the paper.
"""

import fpsolve as fp

webs = {}
for noise in (1.0, 10.0):
    model = fp.SmoothLayDownModel(
        fp.QuadraticPotential(), 1.0, noise, fp.MovingBelt(0.1)
    )
    webs[noise] = fp.lay_web(
        model, width=10.0, length=20.0, pixel=0.02, spacing=0.25, seed=10
    )
figure = fp.plotting.plot_web(
    list(webs.values()), titles=["$RK = 1$", "$RK = 10$"], opacity=0.015
)

# %%
# **What is seen.** Light through the webs, the belt moving along the long side. With
# little noise the fibre runs in arcs as wide as the throwing range, and the web is
# even. With much noise the curvature has the variance :math:`K^2 R/2 = 50`: the fibre
# curls with radii of a seventh, moves on slowly, and leaves clouds and holes.

for noise, web in webs.items():
    print(f"RK = {noise:g}: mean {web.mean_length_density()}, 1/(v d) = 40")
    for zone in (0.1, 0.5, 1.0):
        found = web.coefficient_of_variation(zone)
        formation = web.formation_number(zone)
        print(f"   zones of side {zone:g}: CV {found}, formation {formation}")
    print(f"   MD/CD {web.machine_cross_ratio()}")

# %%
# Small zones of either web see straight pieces, :math:`0.946\,v d/x` of variance, which
# is the formation number 1, as long as they are smaller than the loops. The fibres of
# the second web come back to a zone many times, which makes it uneven.
#
# What the basic model, the limit :math:`R \to 0`, has at the same noise needs no fibre:

basic = fp.LayDownModel(fp.QuadraticPotential(), 1.0, fp.MovingBelt(0.1))
predicted = fp.predict_web(basic, spacing=0.25, zones=[0.1, 0.5, 1.0])
for zone, value, error in zip(
    predicted.zones, predicted.cv, predicted.errors, strict=True
):
    print(f"basic model, A = 1, zones of side {zone:g}: CV {value:.3f} ± {error:.0e}")
print(f"basic model, A = 1: MD/CD {predicted.machine_cross_ratio:.3f}")

# %%
# **Compared with the paper.** Figure 10 shows these two webs, for :math:`RK = 1` and
# 10, and says of them that moderate noise makes an even web; it measures nothing and
# does not name :math:`d`. The basic model at :math:`A = 1` is a little more even than
# the smooth one with :math:`R = 1`, by one to three standard errors. At
# :math:`RK = 10` its fibres curl at a fiftieth, and it is no approximation of the loops
# seen here.
#
# The fibres of the second web remember their place over :math:`v A^2\sigma^2 = 10`,
# half of the web: longer webs know its numbers better.
#
# **Cost.** Ten seconds on one core, half of them for the prediction.
