// A bracket on three feet in mm: a base of 100 x 60 x 10, a wall of 70 at its end, with a rib between them.
// Made with: gmsh -3 -format msh41 bracket_feet.geo
SetFactory("OpenCASCADE");
h = 12;
Box(1) = {0, 0, 4, 100, 60, 10};
Box(2) = {0, 0, 4, 10, 60, 66};
Point(101) = {10, 25, 14}; Point(102) = {60, 25, 14}; Point(103) = {10, 25, 60};
Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 101};
Curve Loop(101) = {101, 102, 103};
Plane Surface(101) = {101};
rib[] = Extrude {0, 10, 0} { Surface{101}; };
Cylinder(11) = {12, 30, 0, 0, 0, 4, 8};
Cylinder(12) = {88, 11, 0, 0, 0, 4, 7};
Cylinder(13) = {88, 49, 0, 0, 0, 4, 7};
BooleanUnion(20) = { Volume{1}; Delete; }{ Volume{2, rib[1], 11, 12, 13}; Delete; };
Cylinder(21) = {-1, 30, 50, 30, 0, 0, 6};
BooleanDifference(30) = { Volume{20}; Delete; }{ Volume{21}; Delete; };
e = 0.01;
Physical Volume("bracket") = {30};
Physical Surface("foot 1") = Surface In BoundingBox {4 - e, 22 - e, -e, 20 + e, 38 + e, e};
Physical Surface("foot 2") = Surface In BoundingBox {81 - e, 4 - e, -e, 95 + e, 18 + e, e};
Physical Surface("foot 3") = Surface In BoundingBox {81 - e, 42 - e, -e, 95 + e, 56 + e, e};
Physical Surface("hole") = Surface In BoundingBox {-e, 23, 43, 31, 37, 57};
Mesh.MeshSizeMax = h;
Mesh.ElementOrder = 2;
