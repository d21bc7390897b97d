#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Writes the meshes of the demo parts: config/parts/<part>/<part>.stl (binary STL, millimetres).

Parts with a <part>.scad beside the mesh are drawn by OpenSCAD (apt-get install openscad). The others are lofts, made
here: a row of closed rings with the same number of vertices, each linked to the next. Neighbouring lofts share the exact
vertices of their seams. Every surface is checked before it is written: closed, turned outwards, no flat triangles.

    scripts/make_demo_parts.py [--output config/parts]
"""

import argparse
import pathlib
import shutil
import subprocess
import tempfile

import numpy as np

import part_mesh

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


# Cast handle --------------------------------------------------------------------------------------------------------
# A lever without a plane or a cylinder: egg-shaped sections that swell, shrink and turn along a spine that bends in two
# directions. No symmetry.

HANDLE_LENGTH, HANDLE_RINGS, HANDLE_SEGMENTS = 112.0, 60, 64
# At a share of the length: half width and half height of the section, its turn about the spine in degrees.
HANDLE_SECTIONS = ((0.00, 17.0, 13.0, 0), (0.15, 17.5, 13.5, 5), (0.38, 9.5, 8.0, 25), (0.62, 12.0, 10.0, 40),
                   (0.82, 14.5, 9.5, 55), (1.00, 11.0, 8.5, 65))
HANDLE_EGG = 0.16                   # by how much a section is wider on one side
HANDLE_CAPS = (13.0, 8.0)           # length over which the ends round off


def smooth_row(shares, values, at):
    """Through the values with continuous slope: cubic pieces whose slope is that between the neighbours."""
    slopes = np.gradient(values, shares)
    i = np.clip(np.searchsorted(shares, at, side='right') - 1, 0, len(shares) - 2)
    span = shares[i + 1] - shares[i]
    u = (at - shares[i]) / span
    return ((2 * u ** 3 - 3 * u ** 2 + 1) * values[i] + (u ** 3 - 2 * u ** 2 + u) * span * slopes[i] +
            (3 * u ** 2 - 2 * u ** 3) * values[i + 1] + (u ** 3 - u ** 2) * span * slopes[i + 1])


def handle_spine(share):
    """Points on the spine and unit tangents."""
    x = share * HANDLE_LENGTH
    point = np.stack([x, 13 * np.sin(np.pi * share * 1.3), 24 * share ** 2 * (1.6 - share)], axis=1)
    slope = np.stack([np.full_like(share, HANDLE_LENGTH), 13 * 1.3 * np.pi * np.cos(np.pi * share * 1.3),
                      24 * (3.2 * share - 3 * share ** 2)], axis=1)
    return point, slope / np.linalg.norm(slope, axis=1, keepdims=True)


def cast_handle():
    share = (1 - np.cos(np.linspace(0, np.pi, HANDLE_RINGS + 1))) / 2  # denser where the ends round off
    table = np.array(HANDLE_SECTIONS)
    half_width, half_height, turn = (smooth_row(table[:, 0], table[:, k], share) for k in (1, 2, 3))
    from_end = np.minimum(share * HANDLE_LENGTH / HANDLE_CAPS[0], (1 - share) * HANDLE_LENGTH / HANDLE_CAPS[1])
    cap = np.sqrt(1 - (1 - np.minimum(from_end, 1)) ** 2)
    t = np.arange(HANDLE_SEGMENTS) * 2 * np.pi / HANDLE_SEGMENTS
    across = (half_width * cap)[:, None] * np.cos(t)
    upward = (half_height * cap)[:, None] * np.sin(t) * (1 + HANDLE_EGG * np.cos(t))
    c, s = np.cos(np.radians(turn))[:, None], np.sin(np.radians(turn))[:, None]
    point, tangent = handle_spine(share)
    side = np.cross([0.0, 0.0, 1.0], tangent)
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    up = np.cross(tangent, side)
    rings = point[:, None] + (c * across - s * upward)[..., None] * side[:, None] + \
        (s * across + c * upward)[..., None] * up[:, None]
    return loft(rings)


# Parts drawn in OpenSCAD --------------------------------------------------------------------------------------------

def from_scad(source):
    if shutil.which('openscad') is None:
        raise SystemExit(f'openscad is missing, which draws {source}: apt-get install openscad')
    with tempfile.TemporaryDirectory() as folder:
        mesh = pathlib.Path(folder) / 'part.stl'
        result = subprocess.run(['openscad', '-o', mesh, source], capture_output=True, text=True)
        if result.returncode != 0 or 'WARNING' in result.stderr:
            raise SystemExit(f'openscad cannot draw {source}:\n{result.stderr}')
        return part_mesh.in_fixed_order(part_mesh.read_ascii_stl(mesh.read_text()))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    folder = pathlib.Path(__file__).resolve().parent.parent / 'config' / 'parts'
    parser.add_argument('--output', type=pathlib.Path, default=folder, help='folder of the parts')
    arguments = parser.parse_args()
    makers = {make.__name__: make for make in (three_way_tube, upright_column, cast_handle)}
    makers.update({source.stem: lambda source=source: from_scad(source) for source in sorted(folder.glob('*/*.scad'))})
    for name, make in makers.items():
        vertices, faces = part_mesh.weld(make())
        part_mesh.check(name, vertices, faces)
        size = vertices.max(axis=0) - vertices.min(axis=0)
        print(f'{name}: {len(faces)} triangles, size {size[0]:.3f} x {size[1]:.3f} x {size[2]:.3f} mm, '
              f'volume {part_mesh.volume(vertices, faces) / 1000:.2f} cm^3')
        part_mesh.write_stl(arguments.output / name / f'{name}.stl', name, vertices, faces)


if __name__ == '__main__':
    main()
