// A twelve-degree sector of a disc with the slot for the blade root of blade_root.geo, in mm; the axis is at (0, -280).
// Made with: gmsh -2 -format msh41 disc_sector.geo
coarse = 10;
middle = 2.5;
fine = 0.8;
finest = 0.4;    // along the flanks
half = 6*Pi/180; // half the angle of the sector
axis = -280;
rim = 24;
bore = -100;
R = 8;           // radius of the flank's upper end
r = 2;           // of the slot below the flank
b = 3;           // of the slot's bottom corners
w = Sqrt(0.5);
q = Tan(22.5*Pi/180);

// The flank lies on x + y = 29, as the blade's; its upper end is rounded from (10, 19) + 5 (w, -w) on.
For i In {0:1}
  s = 1 - 2*i;   // right, left
  n = 20*i;
  Point(n + 1) = {s*(10 + 5*w + R*w - R), 19 - 5*w + R*w, 0, fine};
  Point(n + 2) = {s*(10 + 5*w + R*w), 19 - 5*w + R*w, 0, fine};         // center
  Point(n + 3) = {s*(10 + 5*w), 19 - 5*w, 0, finest};
  Point(n + 4) = {s*(21 - r*q*w), 8 + r*q*w, 0, finest};
  Point(n + 5) = {s*(21 - r), 8 - r*q, 0, fine};                        // center
  Point(n + 6) = {s*21, 8 - r*q, 0, fine};
  Point(n + 7) = {s*21, b - 3, 0, middle};
  Point(n + 8) = {s*(21 - b), b - 3, 0, middle};                        // center
  Point(n + 9) = {s*(21 - b), -3, 0, middle};
  Point(n + 10) = {s*(rim - axis)*Tan(half), rim, 0, middle};
  Point(n + 11) = {s*(bore - axis)*Tan(half), bore, 0, coarse};
  Point(n + 12) = {s*(10 + 5*w + R*w - R), rim, 0, fine};
  Line(n + 1) = {n + 12, n + 1};
  Circle(n + 2) = {n + 1, n + 2, n + 3};
  Line(n + 3) = {n + 3, n + 4};
  Circle(n + 4) = {n + 4, n + 5, n + 6};
  Line(n + 5) = {n + 6, n + 7};
  Circle(n + 6) = {n + 7, n + 8, n + 9};
  Line(n + 7) = {n + 10, n + 12};
  Line(n + 8) = {n + 11, n + 10};
EndFor
Line(9) = {9, 29};
Line(10) = {31, 11};
Curve Loop(1) = {10, 8, 7, 1:6, 9, -26:-21, -27, -28};
Plane Surface(1) = {1};
Mesh.ElementOrder = 2;
Physical Curve("right flank") = {2, 3};
Physical Curve("left flank") = {22, 23};
Physical Curve("right side") = {8};
Physical Curve("left side") = {28};
Physical Surface("disc") = {1};
