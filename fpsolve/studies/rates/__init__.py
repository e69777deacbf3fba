"""How fast the density forgets its start, as a function of the noise.

`rate_versus_noise` puts runs, spectra, variances of averages and proven bounds side by
side; `sweep` runs any function over many cases. Names are loaded from their modules.
"""
