"""Fibre steps per second of a web, and what path, raster and tensor take of them.

    python validation/performance/webs.py            # 1 m x 0.5 m of a spunbond process
    python validation/performance/webs.py --quick    # 0.1 m x 0.1 m

One thread, CPU seconds. A leg of steps is taken and laid as `lay_web` does it; the
tensor is what the kernel takes longer than one without its two lines.
"""

from __future__ import annotations

import argparse
import os
import time
import types
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402

import fpsolve as fp  # noqa: E402
from fpsolve._kernels import raster as kernels  # noqa: E402
from fpsolve.web.laying import Laying, image_shape  # noqa: E402
from fpsolve.web.margins import LEG  # noqa: E402
from fpsolve.web.order import order_of  # noqa: E402

# What a core must do, with raster and orientation.
REQUIRED = 5e6
PROCESS = {"sigma1": 5e-3, "sigma2": 5e-3, "noise": 15.0, "speed_ratio": 0.1,
           "spinning_speed": 50.0}  # fmt: skip
SIZES = {False: (1.0, 0.5), True: (0.1, 0.1)}
# Legs that are measured, after two that fill the caches.
N_LEGS, N_WARM = 12, 2
TENSOR = (
    "    image[row, column, 1] += int(amount * direction[0] + 0.5)\n",
    "    image[row, column, 2] += math.floor(amount * direction[1] + 0.5)\n",
)


def without_tensor() -> Any:
    """The kernels of the raster, compiled anew without the lines of the tensor."""
    source = Path(kernels.__file__).read_text("utf-8").replace("cache=True, ", "")
    for line in TENSOR:
        assert line in source, line
        source = source.replace(line, "")
    module = types.ModuleType("raster_without_tensor")
    exec(compile(source, kernels.__file__, "exec"), module.__dict__)
    return module


def seconds_of_parts(laying: Laying, plain: Any) -> tuple[float, float, float]:
    """CPU seconds of the steps, of laying, and of laying without the tensor."""
    motion, n = laying.motion, min(laying.group, laying.n)
    state = np.ascontiguousarray(laying.state[:, :n])
    trace = np.empty((LEG, len(state), n))
    seconds = np.zeros(3)
    step = laying.plan.margins.n_burn
    for leg in range(N_LEGS + N_WARM):
        corners = laying.plan.corners(motion, state, 0, step)
        times = [time.process_time()]
        motion.advance(state, 0, step, LEG, trace)
        times.append(time.process_time())
        nozzles = laying.plan.nozzles(motion, 0, n, step)
        for module in (kernels, plain):
            module.lay_fibres(
                trace, nozzles, laying.raster, corners.copy(), laying.tallies,
                laying.images,
            )  # fmt: skip
            times.append(time.process_time())
        seconds += np.diff(times) * (leg >= N_WARM)
        step += LEG
    path, both, length = seconds / (N_LEGS * LEG * n)
    return path, both, length


def measure_phases(quick: bool) -> None:
    """Fibres of nozzles that turn, each in its own phase and all in one."""
    nozzle = fp.RotatingNozzle(0.1, radius=2.0, angular_speed=0.5)
    model = fp.LayDownModel(fp.QuadraticPotential(), 1.0, nozzle)
    sizes = {"width": 20.0 if quick else 100.0, "length": 20.0, "pixel": 0.1}
    for phases in ("independent", "in phase"):
        for spacing in (0.1, 0.02):
            options = {**sizes, "spacing": spacing, "phases": phases, "seed": 1}
            plan = order_of(model, **options).plan
            began = time.process_time()
            fp.lay_web(model, **options)
            seconds = time.process_time() - began
            rate = plan.n_fibres * plan.ensemble.schedule.n_steps / seconds
            print(
                f"rotating nozzles, {phases}: {plan.n_fibres} fibres, "
                f"{1e-6 * rate:.1f} million steps a second"
            )
            assert quick or rate > REQUIRED, (rate, REQUIRED)


def main() -> None:
    """Measure both models, a web as a whole, and nozzles that turn."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    quick = parser.parse_args().quick
    plain = without_tensor()
    for length in (None, 5e-3):
        process = fp.Process(**PROCESS, relaxation_length=length)
        name = "basic" if length is None else "smooth"
        width, along = SIZES[quick]
        options = {"width": width, "length": along, "spacing": 2.5e-4,
                   "pixel": 5e-4, "seed": 1}  # fmt: skip
        order = order_of(process, **options)
        images = np.zeros((1, *image_shape(order.plan)), np.int64)
        laying = Laying(order.plan, 0, order.plan.n_fibres, images)
        laying.take_leg(0)
        path, both, counted = seconds_of_parts(laying, plain)
        print(
            f"{name}: path {1e9 * path:.0f} ns a step, length in pixels "
            f"{1e9 * counted:.0f} ns, tensor {1e9 * (both - counted):.0f} ns: "
            f"{1e-6 / (path + both):.1f} million steps a second"
        )
        began = time.process_time()
        web = fp.lay_web(process, titer=1.5e-4, **options)
        seconds = time.process_time() - began
        steps = order.plan.n_fibres * order.plan.ensemble.schedule.n_steps
        rate = steps / seconds
        print(
            f"{name}: {width:g} m x {along:g} m, {web.length_density.size:.3g} pixels, "
            f"{order.plan.n_fibres} fibres, {steps:.3g} steps in {seconds:.1f} CPU "
            f"seconds: {1e-6 * rate:.1f} million a second"
        )
        assert quick or rate > REQUIRED, (rate, REQUIRED)
    measure_phases(quick)


if __name__ == "__main__":
    main()
