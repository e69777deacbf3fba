"""Every wrong argument and array ends in an error that names value and remedy."""

import numpy as np
import pytest
from malformed import problems
from malformed.arguments import ARGUMENTS
from malformed.arrays import ARRAYS, HARMLESS
from malformed.cases import assert_said, parametrised


@parametrised([*ARGUMENTS, *ARRAYS])
def test_a_mistake_is_named_with_its_remedy(case):
    with pytest.raises(case.error) as caught:
        case.do()
    assert_said(str(caught.value), case)
    # Not a subclass that only numpy or the standard library raises.
    assert type(caught.value).__module__ in ("builtins", "fpsolve.errors")


@pytest.mark.parametrize("dress", HARMLESS.values(), ids=HARMLESS)
def test_a_density_in_another_dress_is_the_same_density(dress):
    expected = problems.solve().final
    assert np.array_equal(problems.solve(p0=dress(problems.p0())).final, expected)
