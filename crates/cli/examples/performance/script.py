import sys

import open3d

mesh = open3d.io.read_triangle_mesh(sys.argv[1])
points = mesh.sample_points_poisson_disk(int(sys.argv[2]))
open3d.io.write_point_cloud(sys.argv[3], points)
