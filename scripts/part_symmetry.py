# SPDX-License-Identifier: BSD-3-Clause
# SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
"""Poses modulo the symmetry that part.yaml declares."""
import os

import numpy
import yaml

MAX_GROUP = 120                # elements of a finite symmetry group
CONTINUOUS_STEPS = 720         # of an axis of revolution: half a degree each


def rotation_about(axis, angle, origin):
    """4x4 rotation by angle about the axis through origin."""
    x, y, z = numpy.asarray(axis, float) / numpy.linalg.norm(axis)
    cross = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    motion = numpy.eye(4)
    motion[:3, :3] += numpy.sin(angle) * cross + (1 - numpy.cos(angle)) * cross @ cross
    motion[:3, 3] = origin - motion[:3, :3] @ origin
    return motion


def origin_of(entry):
    return numpy.array(entry.get("origin", [0, 0, 0]), float)


def symmetries(declared):
    """All poses of the part that look the same, from the map `symmetry` of part.yaml."""
    generators = [rotation_about(entry["axis"], 2 * numpy.pi / entry["order"], origin_of(entry))
                  for entry in declared.get("discrete", [])]
    group = [numpy.eye(4)]
    for element in group:  # grows while it is walked, until it is closed
        for generator in generators:
            product = element @ generator
            if len(group) < MAX_GROUP and not any(numpy.allclose(product, other, atol=1e-6) for other in group):
                group.append(product)
    axis = declared.get("continuous")
    if axis:
        turns = [rotation_about(axis["axis"], 2 * numpy.pi * i / CONTINUOUS_STEPS, origin_of(axis))
                 for i in range(CONTINUOUS_STEPS)]
        group = [element @ turn for element in group for turn in turns]
    return numpy.array(group)


def load_symmetries(part_dirs):
    """name of the part -> its symmetric poses"""
    groups = {}
    for part_dir in part_dirs:
        with open(os.path.join(part_dir, "part.yaml"), encoding="utf-8") as file:
            part = yaml.safe_load(file)
        groups[part["name"]] = symmetries(part.get("symmetry") or {})
    return groups


def with_turn(group, detection):
    """The group, extended by the turn about an axis that a detection leaves open."""
    if not detection.undetermined_turn:
        return group
    axis, origin = ([getattr(vector, k) for k in "xyz"] for vector in (detection.turn_axis, detection.turn_origin))
    angles = [0, *detection.turn_angles] if detection.turn_angles else \
        numpy.arange(CONTINUOUS_STEPS) * 2 * numpy.pi / CONTINUOUS_STEPS
    turns = [rotation_about(axis, angle, numpy.array(origin)) for angle in angles]
    # pose_error() moves the truth: a true pose is the estimate, turned, then one of the group; and back.
    return numpy.array([element @ numpy.linalg.inv(turn) for turn in turns for element in group])


def pose_error(estimate, truth, group):
    """(translation, rotation) to the symmetric equivalent of the truth that is nearest in rotation."""
    equivalents = truth @ group
    traces = numpy.einsum("ij,nij->n", estimate[:3, :3], equivalents[:, :3, :3])
    nearest = int(numpy.argmax(traces))
    cosine = numpy.clip((traces[nearest] - 1) / 2, -1, 1)
    return numpy.linalg.norm(estimate[:3, 3] - equivalents[nearest, :3, 3]), numpy.arccos(cosine)
