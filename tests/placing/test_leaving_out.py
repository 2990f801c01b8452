"""The covariance of a pose by clusters, against fits that leave one of them out."""

import numpy as np

from gearwear.placing.least_squares import clustered


def test_each_cluster_counts_for_what_leaving_it_out_changes():
    """Of least squares a fit anew without the cluster says so exactly; few clusters of unlike size are no excuse."""
    random = np.random.default_rng(2)
    cluster = np.repeat(np.arange(6), [9, 14, 20, 25, 30, 12])
    columns = random.normal(size=(len(cluster), 3))
    target = random.normal(size=6)[cluster] + 0.1 * random.normal(size=len(cluster))
    whole = np.linalg.lstsq(columns, target, rcond=None)[0]
    moved = [whole - np.linalg.lstsq(columns[cluster != one], target[cluster != one], rcond=None)[0] for one in range(6)]
    covariance = clustered(columns, target - columns @ whole, np.ones(len(cluster)), cluster)
    np.testing.assert_allclose(covariance, np.einsum("gi,gj->ij", moved, moved), rtol=1e-10)
