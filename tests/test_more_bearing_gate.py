"""The cost of leaving a bearing alone, from the likelihoods that it balances."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import norm

from labsim.bearing_gate import null_pairing_cost


@given(
    spread=st.floats(0.005, 0.3), detection_probability=st.floats(0.05, 0.99), density=st.floats(1e-3, 1.0)
)
def test_at_the_null_cost_a_pair_is_as_likely_as_a_miss_and_a_false_alarm(
    spread, detection_probability, density
):
    difference = np.sqrt(null_pairing_cost(spread, detection_probability, density))
    pair = detection_probability * norm.pdf(difference, scale=spread)
    alone = (1 - detection_probability) * density
    if difference > 0:
        assert pair == pytest.approx(alone, rel=1e-9)
    else:
        assert pair <= alone * (1 + 1e-9)
