// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Elbow of 90 degrees with a socket at each end. Millimetres; arms along +x and +z, their axes cross in the origin.
// Half a turn about [1, 0, 1] swaps the ends.

bend_radius = 32;
body_radius = 13.5;
bore_radius = 9.5;
collar_radius = 17.5;
socket_radius = 13;
end = 52;       // of an arm, from the origin
collar = 15;    // length
socket = 12;    // depth
shoulder = 1.5; // from the body to the collar, as long as high
chamfer = 1;
segments = 64;  // around the pipe: 17.5 mm are met within 0.02 mm
steps = 20;     // along the bend: its outer side is met within 0.04 mm

// [place, radius] from the middle of the arm along x over its end and back; a place is a distance from the origin.
outside = [[end - collar - shoulder, body_radius], [end - collar, collar_radius],
           [end - chamfer, collar_radius], [end, collar_radius - chamfer]];
inside = [[end, socket_radius + chamfer], [end - chamfer, socket_radius],
          [end - socket, socket_radius], [end - socket, bore_radius]];

// A ring about the axis of the arm along x, of the arm along z, and of the bend.
function on_x(p) = [for (i = [0:segments - 1]) let (t = 360 * i / segments) [p[0], p[1] * sin(t), p[1] * cos(t)]];
function on_z(p) = [for (i = [0:segments - 1]) let (t = 360 * i / segments) [p[1] * cos(t), p[1] * sin(t), p[0]]];
function on_bend(turn, radius) = [for (i = [0:segments - 1])
    let (t = 360 * i / segments, r = bend_radius - radius * cos(t))
    [bend_radius - r * sin(turn), radius * sin(t), bend_radius - r * cos(turn)]];
function reversed(list) = [for (i = [len(list) - 1:-1:0]) list[i]];

// All rings in a closed row: outside from the x arm to the z arm, inside back.
rings = concat(
    [for (step = [0:steps]) on_bend(90 * step / steps, body_radius)],
    [for (p = outside) on_z(p)], [for (p = inside) on_z(p)],
    [for (step = [steps:-1:0]) on_bend(90 * step / steps, bore_radius)],
    [for (p = reversed(inside)) on_x(p)], [for (p = reversed(outside)) on_x(p)]);

function corner(ring, i) = (ring % len(rings)) * segments + i % segments;
polyhedron([for (ring = rings) each ring],
    [for (ring = [0:len(rings) - 1], i = [0:segments - 1], upper = [false, true])
        upper ? [corner(ring, i), corner(ring + 1, i + 1), corner(ring, i + 1)]
              : [corner(ring, i), corner(ring + 1, i), corner(ring + 1, i + 1)]], 2);
