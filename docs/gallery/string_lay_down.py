r"""
The string on the belt (figures 3 and 8)
========================================

Figures 3 and 8 of the paper show fibres :math:`\eta` that its string (5) lays down, and
fibres of the two lay-down models that were identified from them. Here the string of
:doc:`/string` is spun from a nozzle at rest and from one that turns, a third of a metre
above the belt, and white noise pulls at it on the way.
"""

import fpsolve as fp
from fpsolve import fibre


def laid(radius, angular_speed):
    """8 m of a stiff thread of 0.2 mm, at 1 m/s on a belt of 0.1 m/s."""
    nozzle = fibre.Nozzle(
        (0, 0, 0.3), (0.02, 0.01, -1), 1.0, (radius, radius), angular_speed
    )
    string = fibre.String(0.25, 2e-4, 1000.0, 3e8, nozzle, fibre.Free(), n_edges=25)
    run = fibre.lay_down(
        string, 8.0, 4000, belt=fibre.Belt(0.1, settling_time=0.3),
        air=fibre.AirFlow((0.0, 0.0, 0.0)), turbulence=fibre.RandomForce(1e-5), seed=3,
        estimate_error=False,
    )  # fmt: skip
    return run.laid_curve(skip=0.5)


transversal = laid(0.0, 0.0)
figure = fp.plotting.plot_fibre_curve(transversal)

# %%
# A nozzle that turns on a circle of 10 cm, with 1.5 rad per metre of fibre:

rotating = laid(0.1, 1.5)
turned = fp.plotting.plot_fibre_curve(rotating)

# %%
# Both models, identified from the first of these fibres:

basic, smooth = (fp.identify(transversal, model=model) for model in ("basic", "smooth"))
compared = fp.plotting.plot_identified_fibres(basic, smooth)

# %%
# **What is seen.** The fibre buckles where it meets the belt and lies in loops, whose
# size is that of a heavy elastic thread, :math:`(EI/\rho A g)^{1/3}` times a few; the
# noise throws them to all sides. Under the nozzle that turns they follow its cycloid.
#
# **Compared with the paper.** The same shapes as its figure 3, of a thread in air at
# rest instead of a fibre in an industrial flow. Fibres of the identified models are as
# wide and as curled as the thread, but the tests of the identification tell them from
# it (small p-values): a thread prefers loops of one size, which neither model knows.

size = (3e8 * 2e-4**2 / (16 * 1000.0 * 9.81)) ** (1 / 3)
print(f"size of a heavy elastic thread: {100 * size:.1f} cm")
print(basic)
print(smooth)

# %%
# **Cost.** Nine seconds of CPU time: a third of one for a metre of fibre with edges of
# a centimetre, and two for the identifications.
