"""Compiled parts of SciPy without its packages."""

import subprocess
import sys

import numpy as np
from scipy.linalg import cho_solve_banded, cholesky_banded

from scenic.graph.scipy_parts import compiled_part


def test_packages_can_be_imported_later() -> None:
    script = (
        "import sys; from scenic.graph.scipy_parts import compiled_part; "
        "lapack = compiled_part('scipy.linalg', '_flapack', ['dpbtrf'], 'scipy.linalg.lapack'); "
        "assert not {'scipy.linalg', 'scipy.linalg.lapack', 'scipy.special'} & set(sys.modules); "
        "from scenic.graph.operations.normal_functions import ndtri; value = ndtri(0.3); "
        "assert 'scipy.special' not in sys.modules; from scipy import linalg, special, stats; "
        "assert linalg.lapack.dpbtrf is lapack.dpbtrf; assert linalg.det([[2.0, 0.0], [0.0, 3.0]]) == 6.0; "
        "assert special.ndtri(0.3) == value == stats.norm.ppf(0.3); assert special.gamma(5) == 24"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


def test_a_missing_function_means_the_public_module() -> None:
    from scipy.linalg import lapack

    assert compiled_part("scipy.linalg", "_flapack", ["dnothing"], "scipy.linalg.lapack") is lapack


def test_lapack_solves_as_scipy_does() -> None:
    lapack = compiled_part("scipy.linalg", "_flapack", ["dpbtrf", "dpbtrs"], "scipy.linalg.lapack")
    draws = np.random.default_rng(1)
    bands = draws.uniform(-1, 1, (4, 60))
    bands[0] += 8
    right = draws.uniform(-1, 1, (60, 2))
    factors, failure = lapack.dpbtrf(bands, lower=1)
    known = cholesky_banded(bands, lower=True)
    assert not failure
    assert (lapack.dpbtrs(factors, right, lower=1)[0] == cho_solve_banded((known, True), right)).all()
