"""Below every figure a caption, and in its place a text for those who do not see it."""

from __future__ import annotations

__all__ = ["CAPTIONS"]

# By the kind of a result and the name of its figure.
CAPTIONS = {
    "solution/overview": (
        "The run on one page: ∫ p dα at four saved s, with the contours that enclose "
        "50 and 95 % of the equilibrium in white; relative entropy; law of the angle; "
        "spread.",
        "Maps of the density over the plane, and curves of entropy, angle and spread",
    ),
    "solution/marginals": (
        "∫ p dα at saved s; white: contours of the equilibrium.",
        "Maps of the density over the plane at saved arclengths",
    ),
    "solution/overview, smooth": (
        "The run on one page: ∫ p dα dκ at four saved s; relative entropy to a given "
        "reference, or else the mean position; law of the angle; spread.",
        "Maps of the density over the plane, and curves of position, angle and spread",
    ),
    "solution/marginals, smooth": (
        "∫ p dα dκ at saved s.",
        "Maps of the density over the plane at saved arclengths",
    ),
    "solution/angle": ("∫ p dξ at saved s.", "Law of the angle at saved arclengths"),
    "solution/entropy": (
        "Relative entropy above its value on the grid, and its dissipation.",
        "Relative entropy and dissipation against arclength, logarithmic",
    ),
    "solution/moments": (
        "Means, variances and the mean direction.",
        "Moments of the density against arclength",
    ),
    "paths/ensemble": (
        "Histograms at the last saved s, and moments with bands of one standard error; "
        "white: contours that enclose 50 and 95 % of the equilibrium.",
        "Histograms of deviation and angle, and moments of the paths",
    ),
    "paths/ensemble, smooth": (
        "Histograms at the last saved s, and moments with bands of one standard error.",
        "Histograms of deviation and angle, and moments of the paths",
    ),
    "paths/trajectory": (
        "One path: the deviation ξ in the plane.",
        "A single path of the process",
    ),
    "paths/fibre": (
        "One fibre on the belt, as it is laid down.",
        "A single fibre on the moving belt",
    ),
    "fibre-curve/fibre": (
        "The beginning of the fibre on the belt, as it was measured.",
        "A fibre on the belt, and its reference curve where it is known",
    ),
    "fibre-motion/motion": (
        "The fibre at several times, from the side, and its energies.",
        "Shapes of a moving fibre, and its energies over time",
    ),
    "fibre-lay-down/lay_down": (
        "The fibre on the belt, in its frame; the part in the air at several times.",
        "A fibre on a belt, and what hangs between it and the nozzle",
    ),
    "identification/fibres": (
        "The fibre that was measured, and one of the identified model.",
        "A measured fibre and one of the model beside it",
    ),
    "identification/increments": (
        "Increments of angle and curvature against the length between them; bands "
        "hold 95 % of the model's own fibres.",
        "Curves of the increments of data and model with bands",
    ),
    "identification-comparison/fibres": (
        "The fibre that was measured, and one of each identified model.",
        "A measured fibre and one of each model beside it",
    ),
    "identification-comparison/increments": (
        "Increments of angle and curvature against the length between them; bands "
        "hold 95 % of a model's own fibres.",
        "Curves of the increments of data and both models with bands",
    ),
    "hydrodynamic/hydrodynamic": (
        "Plane densities at saved s; white: contours of the stationary density.",
        "Maps of the density, and curves of entropy, means and spread",
    ),
    "energy/law": (
        "Law of the energy at saved s; dashed: the stationary law.",
        "Curves of the density of the energy, and of its entropy",
    ),
    "steady-state/stationary": (
        "Left: the density over the plane; white: contours of c exp(-B). Right: the "
        "density of the angle; dashed: uniform.",
        "Map of the stationary density and curve over the angle",
    ),
    "mean-pattern/pattern": (
        "Expected length of fibre per area, relative to its mean, on a square of "
        "several cells of the pattern.",
        "Map of the expected length of fibre per area",
    ),
    "periodic-state/phases": (
        "Above: the density over the plane at four phases of the period; white: "
        "contours of c exp(-B). Below: E ξ and E τ over the period.",
        "Maps of the density at four phases and curves of its means",
    ),
    "spectral/series": (
        "Relative entropy and means over s, with estimated errors.",
        "Curves of entropy and means",
    ),
    "smooth-spectral/series": (
        "Variances and means over s, with estimated errors.",
        "Curves of variances and means",
    ),
    "hydrodynamic-paths/moments": (
        "Means and variances of the paths, with standard errors.",
        "Curves of means and variances",
    ),
    "energy-paths/energies": (
        "Histograms of the signed energy at saved s; dashed: the stationary density.",
        "Histograms of the energy",
    ),
    "check/check": (
        "Marginals of the density (lines) and of the paths (points); beneath, the "
        "deviation of every cell in standard deviations.",
        "Marginals of density and paths with their deviations",
    ),
    "spectrum/spectrum": (
        "Eigenvalues in the complex plane, by sector; dashed: where the gap ends.",
        "Eigenvalues in the complex plane",
    ),
    "web-prediction/zones": (
        "CV of square zones with errors; dashed: zones that straight fibres cross.",
        "Curve of the coefficient of variation against the side of the zone",
    ),
    "rate/integral": (
        "Inverse decay rate ∫ H ds against noise, as in figure 5 of the paper.",
        "Curve of the inverse decay rate against noise",
    ),
    "rate/rates": (
        "Decay rates of the leading modes, of the runs, and what is proven.",
        "Curves of decay rates and bounds against noise",
    ),
    "rate/averages": (
        "Asymptotic variances against noise.",
        "Curves of asymptotic variances against noise",
    ),
    "large-noise/distances": (
        "Distances against the small parameter; thin lines: the slope that is derived.",
        "Distances to the limit against the small parameter, logarithmic",
    ),
    "white-noise/distances": (
        "Distances against R; thin lines: the slope that is derived.",
        "Distances to the limit against the relaxation length, logarithmic",
    ),
    "web-design/design": (
        "Left: CV of zones against throughput along the front, or along the search "
        "where there is none; circle: start, star: optimum, bars: webs laid there, two "
        "standard errors, dotted: bounds. Right: per cent of CV per per cent of a "
        "parameter.",
        "Curves of the variation against throughput, and bars of its sensitivities",
    ),
    "nozzle-design/pattern": (
        "CV of the mean pattern wherever it was computed; star: optimum, shaded or "
        "framed: where it may be.",
        "Variation of the pattern against the free numbers of the nozzle, logarithmic",
    ),
    "web-homogeneity/zones": (
        "CV of square zones against their side; lines: predicted; markers: laid webs "
        "with standard errors.",
        "CV of laid and predicted webs against the side of zones, logarithmic",
    ),
    "small-noise/distances": (
        "Distances against the small parameter; thin lines: the slope that is derived.",
        "Distances to the limit against the small parameter, logarithmic",
    ),
    "small-noise-spectrum/spectrum": (
        "Slowest real rates of the sectors M = 0 over A²; dashed: the energy process.",
        "Rates of both families against noise",
    ),
    "energy-tables/orbits": (
        "Orbits of the deterministic motion and their fibres.",
        "Level curves of the energy and fibres of some energies",
    ),
    "energy-tables/coefficients": (
        "Period and variance against energy.",
        "Curves of period and variance against energy",
    ),
    "energy-tables/eigenfunctions": (
        "Slowest modes of both families.",
        "Curves of the slowest eigenfunctions against energy",
    ),
    "averages/averages": (
        "Error of one average against s, and the limits of s times squared error "
        "against the noise.",
        "Curves of errors against arclength and of variances against noise",
    ),
    "web/light": (
        "The web against light; the mean lets 55 % of it pass.",
        "Fibres of the web in grey, denser places darker",
    ),
    "web/mass": (
        "Mass per area of every pixel, or laid length where no titer is known; the "
        "densest pixel in two hundred shares one colour.",
        "Map of the mass per area",
    ),
    "web/variation": (
        "Coefficient of variation of square zones with standard errors; dashed: random "
        "straight fibres of the same length per area.",
        "Coefficient of variation against the side of zones, logarithmic",
    ),
    "web/rose": (
        "Density of laid length over directions, with standard errors; the machine "
        "direction points to the right.",
        "Polar bars of the length in each direction",
    ),
    "web/spectrum": (
        "Power spectrum over the mean density: all wave vectors, mean over rings with "
        "standard errors, and sections in machine and cross direction.",
        "Map of the power over wave vectors, and curves against the wave number",
    ),
}
