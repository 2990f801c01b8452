"""Sums and means over sections that are pooled."""

from __future__ import annotations

import numpy as np

from gearwear.arrays import Floats, Ints


def about_places(place: Ints, widths: Ints, drawn: Floats, made: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Means over the pooled sections of `drawn` and `made`, (teeth, n_z), the least of their sum from half way to the place before to half way to
    the next, or to the end of the face, and `drawn` where that is, (teeth, places) each; nan where there is no place."""
    result = np.full((4, *place.shape), np.nan)
    n, both = drawn.shape[1], drawn + made
    for tooth, width in enumerate(widths.tolist()):
        columns = np.flatnonzero(place[tooth] >= 0)
        at = place[tooth, columns]
        number = running_sum(np.ones(n), width)[at]
        result[:2, tooth, columns] = [running_sum(values[tooth], width)[at] / number for values in (drawn, made)]
        edges = np.concatenate([[0], (at[1:] + at[:-1] + 1) // 2, [n]])
        for column, low, high in zip(columns, edges[:-1], edges[1:], strict=True):
            # Where two places are the same distance away, the section belongs to both.
            near = slice(max(low - 1, 0), high)
            at_least = int(np.argmin(np.nan_to_num(both[tooth, near], nan=np.inf)))
            result[2:, tooth, column] = both[tooth, near][at_least], drawn[tooth, near][at_least]
    return result[0], result[1], result[2], result[3]


def running_sum(values: Floats, width: int) -> Floats:
    """Sum over a centred window along the last axis, cut off at the ends."""
    total = np.concatenate([np.zeros((*values.shape[:-1], 1)), np.cumsum(values, axis=-1)], axis=-1)
    at = np.arange(values.shape[-1])
    low, high = np.maximum(at - width // 2, 0), np.minimum(at + width // 2 + 1, values.shape[-1])
    return np.asarray(total[..., high] - total[..., low], dtype=np.float64)
