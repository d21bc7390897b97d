#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Writes the meshes of the demo parts: config/parts/<part>/<part>.stl (binary STL, millimetres).

Both parts are lofts: a row of closed rings with the same number of vertices, each linked to the next. Neighbouring
lofts share the exact vertices of their seams, so the surface is watertight by construction; it is checked before it is
written.

    scripts/make_demo_parts.py [--output config/parts]
"""

import argparse
import pathlib
import struct

import numpy as np

SEGMENTS = 96  # of a full turn: facets turn by 3.75 degrees, a 15 mm radius is met within 0.01 mm


def loft(rings, closed=False):
    """Triangles (n, 3, 3) between consecutive rings; the outside is to the right when the first ring runs
    counter-clockwise seen against the direction of the loft."""
    rings = np.asarray(rings, dtype=float)
    follower = np.roll(rings, -1, axis=0) if closed else rings[1:]
    leader = rings if closed else rings[:-1]
    a, b = leader, np.roll(leader, -1, axis=1)
    d, c = follower, np.roll(follower, -1, axis=1)
    pairs = ((a, b, c), (a, c, d))
    return np.concatenate([np.stack(corners, axis=2).reshape(-1, 3, 3) for corners in pairs])


# Three-way tube -----------------------------------------------------------------------------------------------------
# Run along x, branch along +z, all three arms of equal radii: their surfaces meet in the planes x = 0 and z = |x|.

BODY_RADIUS, BORE_RADIUS, COLLAR_RADIUS = 15.0, 11.0, 17.5
COLLAR_LENGTH, CHAMFER, SHOULDER = 13.0, 1.0, 1.5
RUN_HALF_LENGTH, BRANCH_LENGTH = 45.0, 50.0


def arm_profile(length):
    """(axial, radius) from the outer seam over the end to the inner seam; None: where the seam is."""
    start = length - COLLAR_LENGTH
    return [(None, BODY_RADIUS), (start - SHOULDER, BODY_RADIUS), (start, COLLAR_RADIUS),
            (length - CHAMFER, COLLAR_RADIUS), (length, COLLAR_RADIUS - CHAMFER), (length, BORE_RADIUS + CHAMFER),
            (length - CHAMFER, BORE_RADIUS), (None, BORE_RADIUS)]


def exact_circle():
    """Unit circle whose vertices mirror exactly in both axes, so that seams of different arms share their vertices."""
    quarter = np.arange(SEGMENTS // 4) * 2 * np.pi / SEGMENTS
    c, s = np.cos(quarter), np.sin(quarter)
    s[0], eighth = 0.0, SEGMENTS // 8
    s[eighth] = c[eighth]
    s[eighth + 1:] = c[1:eighth][::-1]
    return np.concatenate([c, -s, -c, s]), np.concatenate([s, c, -s, -c])


def three_way_tube():
    c, s = exact_circle()
    zero = np.zeros_like(c)
    parts = []
    for direction in (1, -1):  # halves of the run: angle from +z, so cos is the height over the axis
        rings = []
        for axial, radius in arm_profile(RUN_HALF_LENGTH):
            x = np.maximum(radius * c, 0) if axial is None else zero + axial
            rings.append(np.stack([direction * x, -direction * radius * s, radius * c], axis=1))
        parts.append(loft(rings))
    rings = []
    for axial, radius in arm_profile(BRANCH_LENGTH):
        z = np.abs(radius * c) if axial is None else zero + axial
        rings.append(np.stack([radius * c, radius * s, z], axis=1))
    parts.append(loft(rings))
    return np.concatenate(parts)


# Upright column -----------------------------------------------------------------------------------------------------
# Base plate 60 x 44 mm in z = 0, axis z. One rib on +x and a flat on -x leave no symmetry.

PLATE, PLATE_CORNER, PLATE_HEIGHT = (30.0, 22.0), 7.0, 8.0
COLUMN_RADIUS, COLUMN_TOP = 15.0, 72.0
FLANGE_RADIUS, FLANGE_TOP = 19.0, 80.0
POST_RADIUS, POST_FLAT, HEIGHT = 11.0, 7.5, 110.0
RIB_HALF_WIDTH, RIB_REACH, RIB_TOP = 3.5, 27.0, 52.0
COLUMN_BORE = 5.5


def column_angles():
    """Even steps plus the corners of the rib and of the flat, so that edges are met exactly."""
    corner = np.array([np.arctan2(RIB_HALF_WIDTH, RIB_REACH), np.arcsin(RIB_HALF_WIDTH / COLUMN_RADIUS)])
    flat = np.pi - np.arccos(POST_FLAT / POST_RADIUS)
    special = np.concatenate([corner, -corner % (2 * np.pi), [flat, 2 * np.pi - flat]])
    even = np.arange(SEGMENTS) * 2 * np.pi / SEGMENTS
    gap = np.abs((even[:, None] - special + np.pi) % (2 * np.pi) - np.pi).min(axis=1)
    return np.sort(np.concatenate([even[gap > 0.2 * 2 * np.pi / SEGMENTS], special]))


def rounded_rectangle(angles, inset=0.0):
    half = np.array(PLATE) - inset
    radius = PLATE_CORNER - inset
    core = half - radius
    out = []
    for t in angles:
        direction = np.abs([np.cos(t), np.sin(t)])
        reach = (half / np.maximum(direction, 1e-12)).min()
        if (direction * reach > core + 1e-12).all():  # the ray leaves through the corner's arc
            along = direction @ core
            reach = along + np.sqrt(along ** 2 - core @ core + radius ** 2)
        out.append(reach * np.array([np.cos(t), np.sin(t)]))
    return np.array(out)


def circle(angles, radius):
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)


def ribbed(angles):
    """Outline of the column with its rib at the foot, and the points of the column that the rib runs up to."""
    foot = circle(angles, COLUMN_RADIUS)
    rib = foot[:, 0] > np.sqrt(COLUMN_RADIUS ** 2 - RIB_HALF_WIDTH ** 2) - 1e-9
    head = foot.copy()
    slope = np.tan(angles[rib])
    x = np.minimum(RIB_REACH, RIB_HALF_WIDTH / np.maximum(np.abs(slope), 1e-12))
    foot[rib] = np.stack([x, x * slope], axis=1)
    head[rib] = np.stack([np.sqrt(COLUMN_RADIUS ** 2 - foot[rib, 1] ** 2), foot[rib, 1]], axis=1)
    return foot, head


def flattened(angles, radius, flat):
    c = np.cos(angles)
    reach = np.where(c < 0, np.minimum(radius, flat / np.maximum(-c, 1e-12)), radius)
    return reach[:, None] * circle(angles, 1.0)


def upright_column():
    t = column_angles()
    foot, head = ribbed(t)
    outline = [(rounded_rectangle(t, CHAMFER), 0), (rounded_rectangle(t), CHAMFER),
               (rounded_rectangle(t), PLATE_HEIGHT - CHAMFER), (rounded_rectangle(t, CHAMFER), PLATE_HEIGHT),
               (foot, PLATE_HEIGHT), (head, RIB_TOP), (head, COLUMN_TOP), (circle(t, FLANGE_RADIUS), COLUMN_TOP),
               (circle(t, FLANGE_RADIUS), FLANGE_TOP - CHAMFER), (circle(t, FLANGE_RADIUS - CHAMFER), FLANGE_TOP),
               (flattened(t, POST_RADIUS, POST_FLAT), FLANGE_TOP),
               (flattened(t, POST_RADIUS, POST_FLAT), HEIGHT - CHAMFER),
               (flattened(t, POST_RADIUS - CHAMFER, POST_FLAT - CHAMFER), HEIGHT),
               (circle(t, COLUMN_BORE), HEIGHT), (circle(t, COLUMN_BORE), 0)]
    return loft([np.column_stack([xy, np.full(len(t), float(z))]) for xy, z in outline], closed=True)


# Checks and output --------------------------------------------------------------------------------------------------

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


def symmetry_error(vertices, rotation):
    """Largest distance from a rotated vertex to the nearest vertex, mm. Vertices of both parts lie symmetric if the
    surface does."""
    moved = vertices @ rotation.T
    return max(np.sqrt(((vertices - p) ** 2).sum(axis=1).min()) for p in moved)


def write_stl(path, name, vertices, faces):
    corners = vertices[faces].astype(np.float32)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-20)
    record = np.zeros(len(faces), dtype=[('normal', '<f4', 3), ('corners', '<f4', (3, 3)), ('attribute', '<u2')])
    record['normal'], record['corners'] = normals, corners
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(f'{name}, millimetres'.encode().ljust(80, b' ') + struct.pack('<I', len(faces)) + record.tobytes())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    default = pathlib.Path(__file__).resolve().parent.parent / 'config' / 'parts'
    parser.add_argument('--output', type=pathlib.Path, default=default, help='folder of the parts')
    arguments = parser.parse_args()
    for name, make in (('three_way_tube', three_way_tube), ('upright_column', upright_column)):
        vertices, faces = weld(make())
        check(name, vertices, faces)
        size = vertices.max(axis=0) - vertices.min(axis=0)
        half_turn = symmetry_error(vertices, np.diag([-1.0, -1.0, 1.0]))
        print(f'{name}: {len(faces)} triangles, size {size[0]:.3f} x {size[1]:.3f} x {size[2]:.3f} mm, '
              f'volume {volume(vertices, faces) / 1000:.2f} cm^3, half turn about z misses by {half_turn:.3f} mm')
        write_stl(arguments.output / name / f'{name}.stl', name, vertices, faces)


if __name__ == '__main__':
    main()
