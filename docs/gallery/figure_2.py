r"""
Fibres in a turbulent flow (figure 2)
=====================================

Figure 2 of the paper shows 25 fibres that are spun into a turbulent flow and laid on a
belt. Each is an answer of the stochastic string,

.. math::

   \varrho A\,\partial_{tt} r = \partial_s(T\,\partial_s r - \partial_s(EI\,
   \partial_{ss} r)) + \varrho A\,g + a + A\,\dot w_{s,t}, \qquad
   \lVert\partial_s r\rVert = 1 ,

to another white noise, whose strength follows from :math:`k` and :math:`\varepsilon`
of the air. The flow here is a plane jet that widens, slows down and ends at the belt,
with :math:`k` in a fixed proportion to the square of its speed.
"""

import numpy as np

import fpsolve as fp
from fpsolve import fibre

HEIGHT = 0.3


def jet(r, t):
    depth = np.maximum(HEIGHT - r[:, 2], 0.0)
    width = 0.02 + 0.1 * depth
    speed = 60.0 * np.sqrt(0.02 / width) * np.clip(r[:, 2] / 0.03, 0.0, 1.0)
    found = np.zeros_like(r)
    found[:, 2] = -speed * np.exp(-((r[:, 0] / width) ** 2))
    return found


def k(r, t):
    return 0.05 + 0.02 * jet(r, t)[:, 2] ** 2


def dissipation(r, t):
    # Eddies of a centimetre: 0.09^(3/4) k^(3/2) / length.
    return 0.09**0.75 * k(r, t) ** 1.5 / 0.01


air = fibre.AirFlow(jet, k=k, dissipation=dissipation)
nozzle = fibre.Nozzle((0.0, 0.0, HEIGHT), direction=(0.0, 0.0, -1.0), speed=20.0)
thread = fibre.String(
    0.1, diameter=20e-6, density=900.0, youngs_modulus=1e9,
    start=nozzle, end=fibre.Free(), n_edges=20,
)  # fmt: skip
straight = np.array(nozzle.position) + thread.s[:, None] * np.array(nozzle.direction)
laid = [
    fibre.lay_down(
        thread, t_end=0.03, n_steps=600, belt=fibre.Belt(speed=2.0), shape=straight,
        air=air, turbulence=fibre.TurbulentForce(), seed=seed, estimate_error=False,
    )
    for seed in range(25)
]  # fmt: skip
figure = fp.plotting.plot_fibres_in_flow([one.r[-1] for one in laid], air)

# %%
# **What is seen.** Straight under the nozzle, where the jet is faster than the fibre is
# spun; further down the fibre is fed faster than the air takes it along, and eddies
# throw it aside in loops that become wider towards the belt.

lying = np.concatenate([one.landed for one in laid])
print(f"{25 * laid[0].fed:.0f} m were spun, {0.005 * len(lying):.1f} m lie on the belt")
aside = [one.landed[:, 1].std() for one in laid]
print(
    f"across the belt: {1e3 * np.mean(aside):.1f} mm, from fibre to fibre "
    f"{1e3 * np.std(aside):.1f} mm"
)
print(f"edges keep their length to {max(one.stretched.max() for one in laid):.0e}")

# %%
# **Compared with the paper.** The flow of figure 2 is that of a plant, from a flow
# solver; `AirFlow.from_file` reads such tables. The paper's fibres come from a row of
# nozzles, and all of these from one: what tells them apart is the noise alone.
#
# **Cost.** 14 s of CPU time on a machine that others used, 0.9 s for every metre that
# comes out, with edges of 5 mm and steps of 50 µs. With four times as long ones the
# noise of one would turn edges by more than a radian, and `lay_down` would warn.
