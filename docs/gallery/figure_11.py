r"""
Strips and holes of moving nozzles (figure 11)
==============================================

Nozzles that rotate or swing lay the fibre around

.. math::

   \gamma(s) = -v s\, e_1 + (r_1 \cos\omega s,\ r_2 \sin\omega s) .

What a row of them in phase lays down on average follows from the density that comes
back every period, without a random number.
"""

import fpsolve as fp

v = 0.1


def state(radius1, turn, half_width, shape, n_phases=32):
    """The periodic density at A = 1, B = |ξ|²/2, r₂ = 2."""
    curve = fp.EllipticNozzle(v, radius1, 2.0, turn)
    model = fp.LayDownModel(fp.QuadraticPotential(), noise=1.0, curve=curve)
    grid = fp.PhaseSpaceGrid(half_width, shape)
    accuracy = {"ds": 0.5, "tolerance": 1e-5, "error_tolerance": 0.1}
    return fp.periodic_state(model, grid, n_phases=n_phases, **accuracy)


cases = {
    "rotation, ω = 0.05": state(2.0, 0.05, 6.0, (24, 24, 14), 16),
    "rotation, ω = 0.5": state(2.0, 0.5, 7.5, (44, 44, 20)),
    "oscillation, ω = 0.05": state(0.0, 0.05, 6.0, (24, 24, 14), 16),
    "oscillation, ω = 0.5": state(0.0, 0.5, (6.0, 7.0), (36, 40, 20)),
}
patterns = [fp.mean_pattern(one, spacing=4.0) for one in cases.values()]
figure = fp.plotting.plot_pattern(patterns, 25.0, 12.0, list(cases))

# %%
# **What is seen.** The expected mass relative to its mean, of nozzles at distance
# :math:`d = 4`, four throwing ranges. A slow rotation lays bands across the belt, one
# every :math:`L = 2\pi v/\omega`, with holes between them; a slow oscillation leaves
# winding strips. Ten times as fast both have all but vanished, and the straight strips
# of the nozzles are left.

for name, pattern in zip(cases, patterns, strict=True):
    (band, error), (strip, other) = pattern.amplitude(1, 0), pattern.amplitude(0, 1)
    variation, spread = pattern.coefficient_of_variation()
    print(
        f"{name}: L = {pattern.length:.2f}, bands {band:.3f} ± {error:.0e}, "
        f"strips {strip:.3f} ± {other:.0e}, CV {variation:.2f} ± {spread:.0e}"
    )

# %%
# Close nozzles, :math:`d \ll \sigma_2`, leave bands alone, and swinging ones nothing:

for name, one in cases.items():
    close = fp.mean_pattern(one, spacing=0.5)
    print(f"{name}: CV {close.coefficient_of_variation()[0]:.3f}")

# %%
# Webs of single fibres scatter about these patterns, three nozzles in phase on twice
# the length; what is measured on them is the pattern's, within standard errors:

webs = [
    fp.lay_web(
        one.model, width=12.0, length=50.2, pixel=0.1, spacing=4.0,
        phases="in phase", seed=11,
    )
    for one in cases.values()
]  # fmt: skip
second_figure = fp.plotting.plot_web(webs, titles=list(cases))
for name, web, pattern in zip(cases, webs, patterns, strict=True):
    bands = web.strips(direction="cross", period=pattern.length).amplitude
    strips = web.strips(direction="machine", period=4.0).amplitude
    print(
        f"{name}: bands {bands:.3f} ± {bands.standard_error:.3f}, "
        f"pattern {pattern.amplitude(1, 0)[0]:.3f}; strips {strips:.3f} ± "
        f"{strips.standard_error:.3f}, pattern {pattern.amplitude(0, 1)[0]:.3f}"
    )

# %%
# **Compared with the paper.** Figure 11 shows webs of single fibres for
# :math:`r_1 = r_2 = 2` and :math:`r_1 = 0,\ r_2 = 2`; its strips and holes are those of
# the left column, the transition to a homogeneous web with ω is the step to the right
# one. The paper has the smooth model with :math:`RK = 1` and does not name the spacing;
# here it is the basic model with :math:`A = 1`, its limit.
#
# **Cost.** Twenty seconds on one core.
