"""Times other samplers: one command a line on stdin, one answer a line on stdout, in seconds.

Answers begin with "= ", so that what the libraries print is not taken for one. The first answer names the peers.
"""
import sys
import time

import open3d

try:
    import point_cloud_utils
except ImportError:
    point_cloud_utils = None

path = sys.argv[1]
mesh = open3d.io.read_triangle_mesh(path)
names = ["Open3D " + open3d.__version__]
if point_cloud_utils is not None:
    from importlib.metadata import version

    names.append("point-cloud-utils " + version("point-cloud-utils"))
    vertices, faces = point_cloud_utils.load_mesh_vf(path)

works = {
    "open3d-read": lambda n: open3d.io.read_triangle_mesh(path),
    "open3d-uniform": lambda n: mesh.sample_points_uniformly(n),
    "open3d-poisson": lambda n: mesh.sample_points_poisson_disk(n),
    "pcu-random": lambda n: point_cloud_utils.sample_mesh_random(vertices, faces, n),
}

print("=", ", ".join(names), flush=True)
for line in sys.stdin:
    work, count = line.split()
    start = time.perf_counter()
    made = works[work](int(count))
    print("=", time.perf_counter() - start, flush=True)
    del made
