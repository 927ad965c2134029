"""Reads every written point format with other people's programs: NumPy, Open3D, trimesh, MeshLab (pymeshlab).

    pip install numpy open3d trimesh pymeshlab
    python tests/peers.py target/release/ldwrap-cli

Makes a textured mesh in a temporary folder, writes its points in every format, and compares what each program finds with the
CSV file. Prints a line for each program and format; exits with 1 at the first difference.
"""

import csv
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import open3d
import pymeshlab
import trimesh

PROGRAM = Path(sys.argv[1]).resolve()
FORMATS = ["ply", "ply-ascii", "xyz", "csv", "npy", "npz", "json", "obj", "glb"]
COUNT = 200

MESH = """ply
format ascii 1.0
element vertex 6
property double x
property double y
property double z
property uchar red
property uchar green
property uchar blue
property float s
property float t
property float heat
element face 2
property list uchar int vertex_indices
end_header
0 0 0 255 0 0 0 0 20.5
1 0 0 0 255 0 0.5 0 -3
1 2 0 0 0 255 0.5 1 7
0 2 0 9 99 199 0 1 1e-3
2 0 1 0 0 0 1 0 0
2 2 1 255 255 255 1 1 1
4 0 1 2 3
4 1 4 5 2
"""


def linear(srgb):
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def check(program, what, found, expected, tolerance=0.0):
    found, expected = np.asarray(found, dtype=float), np.asarray(expected, dtype=float)
    if found.shape != expected.shape:
        sys.exit(f"{program}: {what}: {found.shape} instead of {expected.shape}")
    worst = np.abs(found - expected).max()
    if not worst <= tolerance:
        sys.exit(f"{program}: {what} differ by up to {worst}")
    print(f"{program:<22} {what:<22} {len(found)} rows, differ by at most {worst:.1e}")


with tempfile.TemporaryDirectory() as folder:
    folder = Path(folder)
    (folder / "mesh.ply").write_text(MESH)
    names = {}
    for form in FORMATS:
        names[form] = str(folder / ("ascii.ply" if form == "ply-ascii" else f"points.{form}"))
        subprocess.run(
            [PROGRAM, "wrap", "mesh.ply", "-q", "-n", str(COUNT), "-o", names[form], "--format", form, "--attributes", "all"],
            cwd=folder,
            check=True,
        )
    rows = list(csv.DictReader(open(names["csv"])))
    column = lambda *keys: np.array([[float(row[key]) for key in keys] for row in rows])
    xyz, normals, uv = column("x", "y", "z"), column("nx", "ny", "nz"), column("u", "v")
    rgb, heat = column("red", "green", "blue"), column("heat")[:, 0]

    check("numpy npy", "positions", np.load(names["npy"]), xyz)
    arrays = np.load(names["npz"])
    check("numpy npz", "positions", arrays["position"], xyz)
    check("numpy npz", "normals", arrays["normal"], normals, 1e-7)
    check("numpy npz", "uv", arrays["uv"], uv, 1e-7)
    check("numpy npz", "colours", arrays["color"][:, :3], rgb)
    check("numpy npz", "heat", arrays["heat"], heat)
    xyz_columns = open(names["xyz"]).readline().lstrip("# ").split()
    table = np.loadtxt(names["xyz"])
    check("numpy xyz", "positions", table[:, :3], xyz)
    check("numpy xyz", "heat", table[:, xyz_columns.index("heat")], heat)
    points = json.load(open(names["json"]))
    check("python json", "positions", [point["position"] for point in points], xyz)
    check("python json", "colours", [point["color"][:3] for point in points], rgb)

    for form in ["ply", "ply-ascii"]:
        cloud = open3d.io.read_point_cloud(names[form])
        check(f"open3d {form}", "positions", cloud.points, xyz)
        check(f"open3d {form}", "normals", cloud.normals, normals, 1e-6)
        check(f"open3d {form}", "colours", np.asarray(cloud.colors) * 255, rgb, 1e-9)
        tensor = open3d.t.io.read_point_cloud(names[form])
        check(f"open3d.t {form}", "heat", tensor.point["heat"].numpy()[:, 0], heat, 1e-12)
        mesh = trimesh.load(names[form])
        check(f"trimesh {form}", "positions", mesh.vertices, xyz)
        check(f"trimesh {form}", "colours", mesh.colors[:, :3], rgb)
        meshes = pymeshlab.MeshSet()
        meshes.load_new_mesh(names[form])
        mesh = meshes.current_mesh()
        check(f"meshlab {form}", "positions", mesh.vertex_matrix(), xyz, 1e-12)
        check(f"meshlab {form}", "normals", mesh.vertex_normal_matrix(), normals, 1e-6)
        check(f"meshlab {form}", "colours", mesh.vertex_color_matrix()[:, :3] * 255, rgb, 1e-3)
        check(f"meshlab {form}", "uv", mesh.vertex_tex_coord_matrix(), uv, 1e-6)
    scene = trimesh.load(names["glb"])
    cloud = next(iter(scene.geometry.values()))
    check("trimesh glb", "positions", cloud.vertices, xyz, 1e-6)
    check("trimesh glb", "colours, linear", cloud.colors[:, :3], linear(rgb / 255) * 255, 1.01)
    meshes = pymeshlab.MeshSet()
    meshes.load_new_mesh(names["obj"])
    check("meshlab obj", "positions", meshes.current_mesh().vertex_matrix(), xyz, 1e-12)
    cloud = trimesh.load(names["obj"])
    check("trimesh obj", "positions", cloud.vertices, xyz)
    xyzonly = folder / "only.xyz"
    np.savetxt(xyzonly, table[:, :3])
    check("open3d xyz", "positions", open3d.io.read_point_cloud(str(xyzonly)).points, xyz, 1e-12)
print("all programs find what was written")
