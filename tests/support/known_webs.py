"""Webs whose variation is known in closed form, in place of predicted ones."""

from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np

NAMES = ("noise", "speed_ratio", "sigma1", "sigma2", "spacing")
OF_SMOOTH = (*NAMES[:4], "relaxation_length", "spacing")


@dataclass(frozen=True)
class KnownWeb:
    """log CV = ½ log(v d) + a (log A − A₀ − log(x)/4)² + b (log v/v₀)² + c (log d/d₀)².

    Of smooth fibres e (log R/R₀)² is added.
    To log CV is added what is `wrong` with it, and `tilt` log (A/25): the errors of CV
    and of its slopes say so.
    """

    a: float = 0.3
    b: float = 0.1
    c: float = 0.05
    e: float = 0.2
    best_noise: float = np.log(60.0)
    best_speed: float = np.log(0.1)
    best_spacing: float = np.log(1e-3)
    best_length: float = np.log(5e-4)
    wrong: float = 0.0
    tilt: float = 0.0

    def best(self, zones):
        """Logarithm of the noise that is best for zones."""
        return self.best_noise + np.log(zones) / 4

    def log_cv(self, noise, speed, spacing, zones):
        """Of logarithms."""
        return (
            0.5 * (speed + spacing)
            + self.a * (noise - self.best(zones)) ** 2
            + self.b * (speed - self.best_speed) ** 2
            + self.c * (spacing - self.best_spacing) ** 2
        )

    def __call__(self, process, *, spacing, zones, **options):
        assert options["gradients"]
        numbers = process.noise, abs(process.speed_ratio), spacing
        noise, speed, d = np.log(numbers)
        added = self.wrong, self.tilt * (noise - np.log(25.0))
        length = process.relaxation_length
        names = NAMES if length is None else OF_SMOOTH
        away = 0.0 if length is None else np.log(length) - self.best_length
        of_length = self.e * away**2
        cv = np.exp(self.log_cv(noise, speed, d, zones) + sum(added) + of_length)
        slopes = np.zeros((len(names), zones.size))
        slopes[0] = 2 * self.a * (noise - self.best(zones)) + self.tilt
        slopes[1] = 0.5 + 2 * self.b * (speed - self.best_speed)
        slopes[-1] = 0.5 + 2 * self.c * (d - self.best_spacing)
        values = [numbers[0], process.speed_ratio, 1.0, 1.0, spacing]
        if length is not None:
            slopes[4] = 2 * self.e * away
            values.insert(4, length)
        of = np.array(values)[:, None]
        errors = np.zeros_like(slopes)
        errors[0] = abs(self.tilt)
        return SimpleNamespace(
            parameters=names,
            cv=cv,
            errors=np.abs(added).sum() * cv,
            gradient=slopes * cv / of,
            gradient_errors=errors * cv / np.abs(of),
        )
