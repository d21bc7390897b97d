# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Triangle meshes of parts: welding, checks, STL files."""

import os
import re
import struct

import numpy as np


def weld(triangles):
    """Vertices and index triples; triangles that collapsed to a line are dropped."""
    flat = np.round(triangles.reshape(-1, 3), 4) + 0.0
    vertices, index = np.unique(flat, axis=0, return_inverse=True)
    index = index.reshape(-1, 3)
    keep = (index[:, 0] != index[:, 1]) & (index[:, 1] != index[:, 2]) & (index[:, 2] != index[:, 0])
    return vertices, index[keep]


def volume(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    return np.einsum('ij,ij->i', a, np.cross(b, c)).sum() / 6


def check(name, vertices, faces):
    """Every directed edge once and its opposite once: closed, orientable, consistently turned; volume > 0: outward."""
    directed = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    keys = directed[:, 0] * len(vertices) + directed[:, 1]
    opposite = directed[:, 1] * len(vertices) + directed[:, 0]
    if len(np.unique(keys)) != len(keys) or not np.array_equal(np.sort(keys), np.sort(opposite)):
        raise SystemExit(f'{name}: the surface is not closed')
    if volume(vertices, faces) <= 0:
        raise SystemExit(f'{name}: the surface is turned inside out')
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    longest = np.max([((p - q) ** 2).sum(axis=1) for p, q in ((a, b), (b, c), (c, a))], axis=0)
    flat = np.linalg.norm(np.cross(b - a, c - a), axis=1) <= 1e-6 * longest
    if flat.any():  # a reader may drop them and leave holes
        raise SystemExit(f'{name}: {flat.sum()} triangles have no area')


def read_ascii_stl(text):
    """Triangles (n, 3, 3)."""
    return np.array(re.findall(r'vertex\s+(\S+)\s+(\S+)\s+(\S+)', text), dtype=float).reshape(-1, 3, 3)


def in_fixed_order(triangles):
    """The same triangles, sorted and each begun at its first corner: OpenSCAD writes them as they lie in memory."""
    rows = [min(tuple(np.roll(t, -k, axis=0).ravel()) for k in range(3)) for t in triangles]
    return np.array(sorted(rows)).reshape(-1, 3, 3)


def write_stl(path, name, vertices, faces):
    corners = vertices[faces].astype(np.float32)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
    record = np.zeros(len(faces), dtype=[('normal', '<f4', 3), ('corners', '<f4', (3, 3)), ('attribute', '<u2')])
    record['normal'], record['corners'] = normals, corners
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_suffix('.tmp')
    temporary.write_bytes(
        f'{name}, millimetres'.encode().ljust(80, b' ') + struct.pack('<I', len(faces)) + record.tobytes())
    os.replace(temporary, path)
