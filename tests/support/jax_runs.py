"""Runs with a start of jax against those of the host, for a process of its own."""

import re

from array_runs import OPTIONS, PROBLEMS, assert_same_run, run, scheme_of, start_of


def main():
    import jax
    import jax.numpy as jnp

    scheme = scheme_of("quadratic", "plain")
    told = ""
    try:
        run(scheme, jnp.asarray(start_of(scheme)))
    except TypeError as error:
        told = str(error)
    said = r"`p0` must hold float64 .* jax, got float32; call jax\.config\.update"
    assert re.match(said, told), told
    jax.config.update("jax_enable_x64", True)
    n_runs = 0
    for problem in PROBLEMS:
        for options in OPTIONS:
            scheme = scheme_of(problem, options)
            p0 = start_of(scheme)
            found = run(scheme, jnp.asarray(p0))
            assert found.provenance["arrays"].startswith("jax ")
            assert_same_run(found, run(scheme, p0))
            n_runs += 1
    print(f"{n_runs} runs are the same")


if __name__ == "__main__":
    main()
