"""Run every validation script; `--quick --without nightly` is what a push runs."""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

HERE = Path(__file__).parent
SCRIPTS = (
    "error_laws.py",
    "entropy_identity.py",
    "path_bias.py",
    "path_marginals.py",
    "smooth_path_orders.py",
    "ergodic_averages.py",
    "spectral_reference.py",
    "sector_errors.py",
    "web_prediction.py",
    "web_gradients.py",
    "web_homogeneity.py",
    "web_design.py",
    "nozzle_design.py",
    "smooth_web_map.py",
    "identification_coverage.py",
    "identification_bias.py",
    "identification_efficiency.py",
    "identification_models.py",
    "stationary_densities.py",
    "stationary_boxes.py",
    "decay_rate_is_the_gap.py",
    "entropy_rate_coverage.py",
    "rate_asymptotes.py",
    "smooth_belt_spectra.py",
    "large_noise_limit.py",
    "small_noise_limit.py",
    "white_noise_limit.py",
    "web_statistics.py",
    "identification.py",
    "string_energy.py",
    "string_noise.py",
    "string_strong_noise.py",
    "string_cosseratbench.py",
    "string_identification.py",
    "string_spunbond.py",
    "reliability/attack.py",
    "reliability/flipped_bytes.py",
    "reliability/kill_and_resume.py",
    "reliability/memory_of_saved_densities.py",
    "reliability/memory_of_streamed_webs.py",
    "performance/run.py",
    "performance/paths.py",
    "performance/reduced.py",
    "performance/smooth_density.py",
    "performance/webs.py",
    "performance/identification.py",
    "performance/levels.py",
    "performance/sectors.py",
    "performance/shifts.py",
    "performance/string_motion.py",
    "performance/array_namespaces.py",
)
# For every night: kills by the dozen, times that a shared machine only blurs, and
# claims that tests hold as well, on other models, shorter arclengths or fewer paths.
NIGHTLY = {
    "entropy_identity.py": "tests/density/test_invariants.py",
    "smooth_path_orders.py": "tests/paths/test_smooth_paths.py",
    "stationary_boxes.py": "tests/density/test_steady_state.py",
    "path_bias.py": "tests/paths/test_path_accuracy.py",
    "ergodic_averages.py": "tests/studies/test_ergodicity.py",
    "web_prediction.py": "tests/web/test_predict_web.py",
    "web_gradients.py": "tests/web/test_web_gradient.py",
    "web_homogeneity.py": "tests/studies/test_web_homogeneity.py",
    "web_design.py": "tests/studies/test_web_design.py",
    "nozzle_design.py": "tests/studies/test_nozzle_design.py",
    "smooth_web_map.py": "tests/spectral/test_smooth_resolvent.py",
    "identification_coverage.py": "tests/studies/test_identification_likelihood.py",
    "identification_bias.py": "tests/studies/test_identification_law.py",
    "identification_efficiency.py": "tests/studies/test_identification_likelihood.py",
    "identification_models.py": "tests/studies/test_identification_comparison.py",
    "spectral_reference.py": "tests/density/test_splitting_orders.py",
    "stationary_densities.py": "tests/density/test_steady_state.py",
    "decay_rate_is_the_gap.py": "tests/studies/test_rate_versus_noise.py",
    "rate_asymptotes.py": "tests/studies/test_bounds.py",
    "smooth_belt_spectra.py": "tests/spectral/test_coupled_gap.py",
    "large_noise_limit.py": "tests/studies/test_large_noise_limit.py",
    "small_noise_limit.py": "tests/studies/test_small_noise_limit.py",
    "white_noise_limit.py": "tests/studies/test_white_noise_limit.py",
    "web_statistics.py": "tests/web/test_zones.py",
    "identification.py": "tests/studies/test_identification.py",
    "string_energy.py": "tests/fibre/test_motion.py",
    "string_noise.py": "tests/fibre/test_random_force.py",
    "string_strong_noise.py": "tests/fibre/test_edge_turns.py",
    "string_cosseratbench.py": "tests/fibre/test_motion.py",
    "string_identification.py": "tests/fibre/test_lay_down.py",
    "string_spunbond.py": "tests/fibre/test_flow_tables.py",
    "reliability/attack.py": "tests/input/test_properties.py",
    "reliability/flipped_bytes.py": "tests/density/test_checkpoint_faults.py",
    "reliability/kill_and_resume.py": "tests/density/test_checkpoint_faults.py",
    "reliability/memory_of_saved_densities.py": "tests/density/test_checkpoint.py",
    "reliability/memory_of_streamed_webs.py": "tests/web/test_streamed_webs.py",
    "performance/run.py": "",
    "performance/paths.py": "",
    "performance/reduced.py": "",
    "performance/smooth_density.py": "",
    "performance/webs.py": "",
    "performance/identification.py": "",
    "performance/levels.py": "",
    "performance/sectors.py": "",
    "performance/shifts.py": "",
    "performance/string_motion.py": "",
    "performance/array_namespaces.py": "",
}


def chosen(options: argparse.Namespace) -> list[str]:
    """The scripts that are asked for, in their order."""
    if options.only == "nightly":
        return [script for script in SCRIPTS if script in NIGHTLY]
    left_out = NIGHTLY if options.without == "nightly" else {}
    return [script for script in SCRIPTS if script not in left_out]


def run(script: str, arguments: list[str], alone: bool) -> bool:
    """Run one script and show what it prints; whether it ended well."""
    command = [sys.executable, str(HERE / script), *arguments]
    if alone:
        print(f"== {script}", flush=True)
        return subprocess.run(command, check=False).returncode == 0
    # Beside others a script gets one core, and its output is shown when it ends.
    one_core = {**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    done = subprocess.run(
        command, check=False, env=one_core, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
    )  # fmt: skip
    print(f"== {script}\n{done.stdout}", end="", flush=True)
    return done.returncode == 0


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument(
        "--jobs", type=int, default=1, help="scripts side by side; times suffer (1)"
    )
    parser.add_argument("--only", choices=["nightly"], help="run these alone")
    parser.add_argument("--without", choices=["nightly"], help="leave these out")
    options = parser.parse_args()
    scripts = chosen(options)
    arguments = ["--quick"] if options.quick else []
    with ThreadPoolExecutor(options.jobs) as pool:
        ended_well = list(
            pool.map(lambda script: run(script, arguments, options.jobs == 1), scripts)
        )
    failed = [one for one, well in zip(scripts, ended_well, strict=True) if not well]
    if failed:
        sys.exit(f"failed: {', '.join(failed)}")


if __name__ == "__main__":
    main()
