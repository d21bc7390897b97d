# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""A simulated bin as a data set of the BOP benchmark, with one scene and one part (lengths in millimetres there)."""
import json
import pathlib
import struct
import zlib

STEP = 0.1  # millimetres per unit of the depth picture


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def write_png(path, width, rows):
    """16 bits, gray."""
    header = struct.pack(">IIBBBBB", width, len(rows), 16, 0, 0, 0, 0)
    data = b"".join(b"\0" + struct.pack(f">{width}H", *row) for row in rows)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(data))
                     + chunk(b"IEND", b""))


def read_depth(pcd):
    """Rows of z, metres, of a binary cloud with the fields x y z."""
    header, data = pcd.read_bytes().split(b"DATA binary\n", 1)
    fields = dict(line.split(" ", 1) for line in header.decode().splitlines() if not line.startswith("#"))
    width, height = int(fields["WIDTH"]), int(fields["HEIGHT"])
    z = [point[2] for point in struct.iter_unpack("<fff", data[:12 * width * height])]
    return width, [z[row * width:(row + 1) * width] for row in range(height)]


def write_ply(stl, path):
    """Each triangle of a binary STL with corners of its own; both in millimetres."""
    data = stl.read_bytes()
    count = struct.unpack_from("<I", data, 80)[0]
    corners = []
    for k in range(count):
        values = struct.unpack_from("<12f", data, 84 + 50 * k)
        corners += [values[3 + 3 * i:6 + 3 * i] for i in range(3)]
    lines = ["ply", "format ascii 1.0", f"element vertex {len(corners)}", "property float x", "property float y",
             "property float z", f"element face {count}", "property list uchar int vertex_indices", "end_header"]
    lines += [" ".join(map(repr, corner)) for corner in corners]
    lines += [f"3 {3 * k} {3 * k + 1} {3 * k + 2}" for k in range(count)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    sizes = [[corner[axis] for corner in corners] for axis in range(3)]
    return [min(axis) for axis in sizes], [max(axis) - min(axis) for axis in sizes]


def write(simulated, part, folder, symmetry):
    """\\param symmetry 4 x 4, row by row, that maps the part onto itself"""
    scene = folder / "val" / "000001"
    (scene / "depth").mkdir(parents=True)
    (folder / "models").mkdir()
    low, size = write_ply(simulated / "parts" / part / f"{part}.stl", folder / "models" / "obj_000001.ply")
    model = {"diameter": sum(edge * edge for edge in size) ** 0.5, "symmetries_discrete": [symmetry]}
    model.update({f"min_{name}": value for name, value in zip("xyz", low)})
    model.update({f"size_{name}": value for name, value in zip("xyz", size)})
    (folder / "models" / "models_info.json").write_text(json.dumps({"1": model}), encoding="utf-8")

    width, rows = read_depth(simulated / "scene.pcd")
    units = [[0 if z != z else round(1000 * z / STEP) for z in row] for row in rows]
    write_png(scene / "depth" / "000000.png", width, units)
    camera = json.loads((simulated / "camera.json").read_text(encoding="utf-8"))
    matrix = [camera["fx"], 0, camera["cx"], 0, camera["fy"], camera["cy"], 0, 0, 1]
    (scene / "scene_camera.json").write_text(json.dumps({"0": {"cam_K": matrix, "depth_scale": STEP}}),
                                             encoding="utf-8")
    truth = json.loads((simulated / "truth.json").read_text(encoding="utf-8"))
    poses = [instance["T_camera_object"] for instance in truth["instances"]]
    (scene / "scene_gt.json").write_text(json.dumps({"0": [
        {"obj_id": 1, "cam_R_m2c": [value for row in T[:3] for value in row[:3]],
         "cam_t_m2c": [1000 * row[3] for row in T[:3]]} for T in poses]}), encoding="utf-8")
    return pathlib.Path(folder)
