// A dovetail blade root with its shank, in mm: two flanks at 45 degrees, rounded corners below, fillets at the neck.
// Made with: gmsh -2 -format msh41 blade_root.geo
coarse = 4;
fine = 0.5;
finest = 0.25;   // where the disc's flank ends
neck = 10;       // half width of the shank
top = 50;        // height of the shank's end
r = 3;           // radius of the fillets at the neck
c = 2;           // radius of the corners below the flanks
side = 19;       // half width of the root
q = Tan(22.5*Pi/180);

// Sharp corners of the right half: (neck, 19) between flank and shank, (side, 10) between flank and side.
For i In {0:1}
  s = 1 - 2*i;   // right, left
  n = 20*i;
  Point(n + 1) = {s*13, 0, 0, coarse};
  Point(n + 2) = {s*side, 5, 0, coarse};
  Point(n + 3) = {s*side, 10 - c*q, 0, fine};
  Point(n + 4) = {s*(side - c), 10 - c*q, 0, fine};                           // center of the corner
  Point(n + 5) = {s*(side - c*q*Sqrt(0.5)), 10 + c*q*Sqrt(0.5), 0, fine};
  Point(n + 6) = {s*(neck + r*q*Sqrt(0.5)), 19 - r*q*Sqrt(0.5), 0, finest};
  Point(n + 7) = {s*(neck + r), 19 + r*q, 0, fine};                           // center of the fillet
  Point(n + 8) = {s*neck, 19 + r*q, 0, fine};
  Point(n + 9) = {s*neck, top, 0, coarse};
  Line(n + 1) = {n + 1, n + 2};
  Line(n + 2) = {n + 2, n + 3};
  Circle(n + 3) = {n + 3, n + 4, n + 5};
  Line(n + 4) = {n + 5, n + 6};
  Circle(n + 5) = {n + 6, n + 7, n + 8};
  Line(n + 6) = {n + 8, n + 9};
EndFor
Line(7) = {9, 29};
Line(8) = {21, 1};
Curve Loop(1) = {8, 1:6, 7, -26:-21};
Plane Surface(1) = {1};
Mesh.ElementOrder = 2;
Physical Curve("right flank") = {3, 4};
Physical Curve("left flank") = {23, 24};
Physical Curve("end") = {7};
Physical Surface("blade") = {1};
