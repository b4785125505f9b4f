"""Every test runs with floating-point errors raised, and hypothesis draws the same examples each time.

With VASCULO_EXPLORE set in the environment it draws new ones.
"""

import os

import numpy as np
import pytest
from hypothesis import settings

settings.register_profile("fixed", derandomize=True)
settings.register_profile("explore")
settings.load_profile("explore" if "VASCULO_EXPLORE" in os.environ else "fixed")


@pytest.fixture(autouse=True)
def _floating_point_errors_raise():
    with np.errstate(divide="raise", over="raise", invalid="raise"):
        yield
