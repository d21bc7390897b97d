// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Bolt with a hexagon head; a smooth cylinder stands for the thread. Millimetres; axis z, the bearing face of the head
// in z = 0, shank towards +z, a corner of the head on +x. Of order 6 about z.

across_flats = 36;
head = 15;
shank_radius = 12;
length = 80;         // of the shank
washer_radius = 16.9;
washer = 0.8;        // height of the bearing face
chamfer = 2;         // of the shank's end
$fn = 96;           // a multiple of 6, so that the facets share the symmetry

// The head's top is turned with 30 degrees until a circle touches the flats.
top_radius = across_flats / 2 - 0.8;
corner_radius = across_flats / 2 / cos(30);

intersection()
{
  translate([0, 0, -head])
    cylinder(r = corner_radius, h = head - washer, $fn = 6);
  rotate_extrude()
    polygon([[0, -head], [top_radius, -head],
             [corner_radius + 1, -head + (corner_radius + 1 - top_radius) * tan(30)], [corner_radius + 1, 0], [0, 0]]);
}
rotate_extrude()
  polygon([[0, -head / 2], [washer_radius, -head / 2], [washer_radius, 0], [shank_radius, 0],
           [shank_radius, length - chamfer], [shank_radius - chamfer, length], [0, length]]);
