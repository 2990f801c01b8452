"""A surface texture with a given standard deviation and correlation length."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from tests.synthetic.outline import Floats

PER_LENGTH = 8
"""Grid nodes per correlation length."""


@dataclass(frozen=True, slots=True)
class Texture:
    """Random field over the surface; its correlation falls to 1/e at `length_mm`.

    `kind` "gauss": exp(−(d/l)²), smooth. "exponential": exp(−d/l), rough.
    """

    sd_um: float
    length_mm: float = 1.0
    kind: Literal["gauss", "exponential"] = "gauss"

    def correlation(self, distance: Floats) -> Floats:
        scaled = distance / self.length_mm
        return np.exp(-(scaled**2)) if self.kind == "gauss" else np.exp(-scaled)


def sample_texture(texture: Texture, period: float, width: float, u: Floats, v: Floats, rng: np.random.Generator) -> Floats:
    """One realisation, in mm, at points (u, v); periodic in u.

    Parameters
    ----------
    texture : Texture
    period : float
        Length of the surface in u, after which it closes; mm.
    width : float
        v runs from 0 to this; mm.
    u, v : (n,) float
    rng : numpy.random.Generator

    Notes
    -----
    White noise on a grid, filtered by the square root of the covariance's spectrum (exact at the nodes), read
    bilinearly; what the interpolation takes from the variance is put back in the mean.
    """
    nu = _fast(math.ceil(period * PER_LENGTH / texture.length_mm))
    step = texture.length_mm / PER_LENGTH
    nv = _fast(math.ceil((width + 4.0 * texture.length_mm) / step) + 1)
    du = period / nu
    lag_u = np.minimum(np.arange(nu), nu - np.arange(nu)) * du
    lag_v = np.minimum(np.arange(nv), nv - np.arange(nv)) * step
    covariance = texture.correlation(np.hypot(lag_u[:, None], lag_v[None, :]))
    spectrum = np.maximum(np.fft.rfft2(covariance).real, 0.0)
    field = np.fft.irfft2(np.fft.rfft2(rng.standard_normal((nu, nv))) * np.sqrt(spectrum), s=(nu, nv))
    # mean variance of bilinear reading at a random place
    near, far = 2.0 / 3.0, 1.0 / 3.0
    kept = near * near + near * far * (covariance[1, 0] + covariance[0, 1]) + far * far * covariance[1, 1]

    i, fu = _split(u / du)
    j, fv = _split(v / step)
    i, j = np.mod(i, nu), np.mod(j, nv)
    flat, right, up = field.ravel(), np.mod(i + 1, nu), np.mod(j + 1, nv)
    low = flat[i * nv + j] * (1.0 - fv) + flat[i * nv + up] * fv
    high = flat[right * nv + j] * (1.0 - fv) + flat[right * nv + up] * fv
    return np.asarray(1e-3 * texture.sd_um / math.sqrt(kept) * (low * (1.0 - fu) + high * fu))


def _split(x: Floats) -> tuple[np.ndarray[tuple[int, ...], np.dtype[np.int64]], Floats]:
    whole = np.floor(x)
    return whole.astype(np.int64), x - whole


def _fast(n: int) -> int:
    """The next length with no prime factor above 5."""
    while True:
        rest = n
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return n
        n += 1
