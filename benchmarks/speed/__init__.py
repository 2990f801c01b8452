"""Speed on a real-sized scan: stage by stage, and against Open3D, manifold3d and CloudCompare on the same data."""
