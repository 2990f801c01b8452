"""Names for the array types that cross the rooms."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Array of double-precision numbers; shape and unit stand where it is used."""

Complexes = NDArray[np.complex128]
"""Array of double-precision complex numbers."""

Ints = NDArray[np.integer]
"""Array of integers of any width."""

Bools = NDArray[np.bool_]
"""Mask."""
