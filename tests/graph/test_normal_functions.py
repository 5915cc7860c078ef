"""The functions of the normal law that are taken from SciPy without its package."""

import numpy as np
from scipy import special

from scenic.graph.operations import normal_functions


def test_they_are_those_of_scipy() -> None:
    places = np.random.default_rng(1).random(500)
    for name in normal_functions.__all__:
        values = -50 * places if name == "ndtri_exp" else places
        assert (getattr(normal_functions, name)(values) == getattr(special, name)(values)).all()
