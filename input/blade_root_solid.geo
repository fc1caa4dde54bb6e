// A dovetail blade root of 40 mm, its axis 15 degrees off that of the disc: flanks at 45 degrees. Lengths in mm.
// Made with: gmsh -3 -format msh41 blade_root_solid.geo
SetFactory("OpenCASCADE");
Point(1) = {-13, 0, 0};  Point(2) = {13, 0, 0};  Point(3) = {19, 5, 0};   Point(4) = {19, 10, 0};
Point(5) = {10, 19, 0};  Point(6) = {-10, 19, 0};
Point(7) = {-19, 10, 0}; Point(8) = {-19, 5, 0};
For i In {1:8}
  Line(i) = {i, (i % 8) + 1};
EndFor
Curve Loop(1) = {1:8};
Plane Surface(1) = {1};
// Slanted: the sections stay parallel, each a little further along x than the one before.
root[] = Extrude {40*Tan(15*Pi/180), 0, 40} { Surface{1}; };
Physical Volume("root") = {root[1]};
Physical Surface("right flank") = {root[5]};
Physical Surface("left flank") = {root[7]};
Physical Surface("neck") = {root[6]};
Mesh.MeshSizeMax = 8;
Mesh.MeshSizeMin = 3;
MeshSize {5, 6} = 4;
Mesh.ElementOrder = 2;
