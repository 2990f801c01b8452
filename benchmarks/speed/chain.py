"""The chain of peers, one process: Open3D's ICP and signed distance, manifold3d's boolean, on a scan and shapes made before.

python -m benchmarks.speed.chain SCAN.ply SHAPES.npz START given|poisson

START names the pose in SHAPES.npz from which ICP starts. The worn gear's triangles are given, or made from the scan's points by Open3D
(normals from 20 neighbours, their signs for nothing, Poisson reconstruction of depth 9).

Prints a JSON line: seconds of wall and processor time per stage, the pose found, the volume of the boolean.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.speed.timing import Cost, timed

Floats = NDArray[np.float64]
Ints = NDArray[np.integer]

TUKEY = 4.685 * 0.010
"""mm: 95 % efficiency at 10 µm noise, the constant that gearwear takes too."""
SETTLED = 1e-7
"""Relative change at which ICP ends: the loosest power of ten that leaves the pose within 0.1 µm of where it would end; Open3D's own
default, 1e-6 and 30 steps, leaves up to 5 µm."""


def main(scan: str, shapes: str, start: str, surface: str) -> dict[str, Any]:
    import manifold3d
    import open3d
    from scipy.spatial import cKDTree

    given = np.load(shapes)
    target = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(given["target"]))
    target.normals = open3d.utility.Vector3dVector(given["normals"])
    tensor = open3d.core.Tensor
    scene = open3d.t.geometry.RaycastingScene()
    scene.add_triangles(tensor(given["vertices"].astype(np.float32)), tensor(given["faces"].astype(np.uint32)))
    registration = open3d.pipelines.registration

    def solid(vertices: Floats, faces: Ints) -> Any:
        return manifold3d.Manifold(manifold3d.Mesh64(vertices, faces.astype(np.uint64)))

    def meshed() -> tuple[Floats, Ints]:
        cloud.points = open3d.utility.Vector3dVector(placed)
        _, normals = timed(lambda: cloud.estimate_normals(open3d.geometry.KDTreeSearchParamKNN(20)))
        near = cKDTree(given["target"]).query(placed)[1]
        found = np.asarray(cloud.normals)
        found *= np.sign((found * given["normals"][near]).sum(axis=1))[:, None]
        cloud.normals = open3d.utility.Vector3dVector(found)
        mesh, poisson = timed(lambda: open3d.geometry.TriangleMesh.create_from_point_cloud_poisson(cloud, depth=9)[0])
        stages["meshing of the scan"] = normals + poisson
        return np.asarray(mesh.vertices), np.asarray(mesh.triangles)

    stages: dict[str, Cost] = {}
    cloud, stages["reading"] = timed(lambda: open3d.io.read_point_cloud(scan))
    found, stages["registration"] = timed(
        lambda: registration.registration_icp(
            cloud, target, 1.0, given[start],
            registration.TransformationEstimationPointToPlane(registration.TukeyLoss(TUKEY)),
            registration.ICPConvergenceCriteria(SETTLED, SETTLED, 300),
        )
    )  # fmt: skip
    pose = np.asarray(found.transformation)
    placed = np.asarray(cloud.points) @ pose[:3, :3].T + pose[:3, 3]
    _, stages["deviation"] = timed(lambda: scene.compute_signed_distance(tensor(placed.astype(np.float32))).numpy())
    if surface == "poisson":
        nominal, worn = (given["vertices"], given["faces"]), meshed()
    else:
        nominal, worn = ((given[f"{name}_vertices"], given[f"{name}_faces"]) for name in ("coarse", "worn"))
    removed, stages["worn solid"] = timed(lambda: (solid(*nominal) - solid(*worn)).volume())
    return {
        "stages": {name: [cost.wall, cost.cpu] for name, cost in stages.items()},
        "pose": pose.tolist(),
        "removed_mm3": removed,
    }


if __name__ == "__main__":
    print(json.dumps(main(*sys.argv[1:])))
