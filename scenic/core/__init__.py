"""Modules of the established Python API; their names are listed in `scenic.established`."""

import sys

from scenic.established import provide

provide(sys.modules[__name__])
