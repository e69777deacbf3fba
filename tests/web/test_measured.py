"""What has a density measures itself as the functions do."""

import numpy as np

from fpsolve.web.statistics.cloudiness import cloudiness
from fpsolve.web.statistics.formation import formation_number
from fpsolve.web.statistics.measures import Measured
from fpsolve.web.statistics.orientation import machine_cross_ratio, orientation_rose
from fpsolve.web.statistics.spectrum import power_spectrum
from fpsolve.web.statistics.strips import strips
from fpsolve.web.statistics.zones import coefficient_of_variation, mean_density


class Woven(Measured):
    def __init__(self, shape):
        generator = np.random.default_rng(1)
        self.length_density = generator.gamma(2.0, size=shape)
        angle = generator.uniform(-1, 1, shape)
        self.direction = np.stack((np.cos(angle), np.sin(angle)), axis=-1)

    @property
    def pixel(self):
        return 0.5

    @property
    def orientation(self):
        return self.direction[..., :, None] * self.direction[..., None, :]


def test_the_methods_of_a_web_are_the_functions_of_its_density():
    web = Woven((40, 60))
    density, pixel, tensor = web.length_density, web.pixel, web.orientation
    block = 4.0
    pairs = [
        (web.mean_length_density(), mean_density(density, pixel)),
        (web.coefficient_of_variation(2.0, block=block),
         coefficient_of_variation(density, pixel, 2.0, block=block)),
        (web.formation_number(1.0), formation_number(density, pixel, 1.0)),
        (web.cloudiness((1.0, 3.0)), cloudiness(density, pixel, (1.0, 3.0))),
        (web.machine_cross_ratio(), machine_cross_ratio(density, pixel, tensor)),
        (web.orientation_rose(n_bins=9)[4],
         orientation_rose(density, pixel, tensor, n_bins=9)[4]),
        (web.power_spectrum(window="none").radial[2],
         power_spectrum(density, pixel, window="none").radial[2]),
        (web.strips(direction="cross", period=3.0).amplitude,
         strips(density, pixel, direction="cross", period=3.0).amplitude),
    ]  # fmt: skip
    for ours, theirs in pairs:
        assert float(ours) == float(theirs)
        assert ours.standard_error == theirs.standard_error
        assert ours.standard_error > 0
    mean = web.mean_orientation
    ratio = float(web.machine_cross_ratio())
    assert abs(mean[0, 0] / mean[1, 1] - ratio) < 1e-12
