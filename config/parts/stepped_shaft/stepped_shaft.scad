// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Turned shaft with four diameters and a keyway. Millimetres; axis +z, the keyway opens towards +x.
// But for the keyway it is a body of revolution.

// [length, diameter] of the steps from z = 0.
step_sizes = [[22, 22], [14, 42], [42, 36], [34, 26]];
chamfer = 1.2;     // of both ends
edge = 0.6;        // chamfer of the edges between
key_width = 10;
key_depth = 5;
key_length = 30;
key_start = 42;    // z of the rounded end
$fn = 96;         // the largest radius is met within 0.02 mm

function start(i) = i == 0 ? 0 : start(i - 1) + step_sizes[i - 1][0];
last = len(step_sizes) - 1;

// An outer edge is broken where the neighbour is thinner.
function bevel(i, neighbour) = neighbour < 0 || neighbour > last ? chamfer
    : step_sizes[neighbour][1] < step_sizes[i][1] ? edge : 0;

// [radius, z] along one step.
function outline(i) = let (r = step_sizes[i][1] / 2, z = start(i), low = bevel(i, i - 1), high = bevel(i, i + 1))
    concat([[r - low, z]], low > 0 ? [[r, z + low]] : [], high > 0 ? [[r, start(i) + step_sizes[i][0] - high]] : [],
           [[r - high, start(i) + step_sizes[i][0]]]);

difference()
{
  rotate_extrude()
    polygon(concat([[0, 0]], [for (i = [0:last]) each outline(i)], [[0, start(last) + step_sizes[last][0]]]));
  translate([step_sizes[2][1] / 2 - key_depth, 0, 0])
    rotate([0, 90, 0])
      linear_extrude(2 * key_depth)
        hull()
          for (z = [key_start + key_width / 2, key_start + key_length - key_width / 2])
            translate([-z, 0])
              circle(d = key_width);
}
