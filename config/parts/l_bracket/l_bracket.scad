// SPDX-License-Identifier: BSD-3-Clause
// SPDX-FileCopyrightText: 2026 The bin_picking_perception authors
// Angle bracket with two ribs. Millimetres; the base lies in z = 0 along +x, the wall stands in x = 0 along +z, both
// are centred about y = 0. The base is longer than the wall and has round holes where the wall has slots: no symmetry.

base = 82;
wall = 68;
width = 64;
plate = 6;
rib = 5;           // thickness
rib_offset = 14;   // middle of a rib from y = 0
rib_base = 50;     // reach of the ribs along the base and up the wall
rib_wall = 36;
hole = 9;          // diameters
large_hole = 22;
corner = 8;        // radius of the free corners
$fn = 64;

// A plate from the edge of the angle to `length`, its free corners rounded.
module plate_outline(length)
{
  hull()
  {
    translate([0, -width / 2])
      square([1, width]);
    for (side = [-1, 1])
      translate([length - corner, side * (width / 2 - corner)])
        circle(corner);
  }
}

module base_outline()
{
  difference()
  {
    plate_outline(base);
    for (x = [24, 68], side = [-1, 1])
      translate([x, side * 23])
        circle(d = hole);
    translate([48, 0])
      circle(d = large_hole);
  }
}

module wall_outline()
{
  difference()
  {
    plate_outline(wall);
    for (side = [-1, 1])
      hull()
        for (z = [48, 56])
          translate([z, side * 16])
            circle(d = hole);
    translate([26, 0])
      circle(d = hole);
  }
}

// Maps x, y of an outline to z, y; its thickness then points along +x.
module upright()
{
  multmatrix([[0, 0, 1, 0], [0, 1, 0, 0], [1, 0, 0, 0]])
    children();
}

linear_extrude(plate)
  base_outline();
upright()
  linear_extrude(plate)
    wall_outline();
for (side = [-1, 1])
  translate([0, side * rib_offset + rib / 2, 0])
    rotate([90, 0, 0])
      linear_extrude(rib)
        polygon([[1, 1], [plate + rib_base, 1], [plate + rib_base, plate],
                 [plate, plate + rib_wall], [1, plate + rib_wall]]);
