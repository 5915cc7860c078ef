"""The functions of the normal law that are taken from SciPy without its package."""

import subprocess
import sys

import numpy as np
from scipy import special

from scenic.graph.operations import normal_functions


def test_they_are_those_of_scipy() -> None:
    places = np.random.default_rng(1).random(500)
    for name in normal_functions.__all__:
        values = -50 * places if name == "ndtri_exp" else places
        assert (getattr(normal_functions, name)(values) == getattr(special, name)(values)).all()


def test_scipy_can_be_imported_later() -> None:
    script = (
        "import sys; from scenic.graph.operations.normal_functions import ndtri; value = ndtri(0.3); "
        "assert 'scipy.special' not in sys.modules; from scipy import special, stats; "
        "assert special.ndtri(0.3) == value == stats.norm.ppf(0.3); assert special.gamma(5) == 24"
    )
    subprocess.run([sys.executable, "-c", script], check=True)
