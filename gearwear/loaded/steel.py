"""What the teeth are made of."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Material:
    """An elastic body; the same for both gears.

    Parameters
    ----------
    elastic_modulus : float
        E, MPa.
    poisson : float
        ν.
    """

    elastic_modulus: float = 206_000.0
    poisson: float = 0.3

    @property
    def plane_modulus(self) -> float:
        """E / (1 − ν²), MPa."""
        return self.elastic_modulus / (1.0 - self.poisson**2)

    @property
    def contact_modulus(self) -> float:
        """E* of two such bodies in contact, E / (2 (1 − ν²)), MPa."""
        return 0.5 * self.plane_modulus
