// An L-shaped bracket of 10 by 10 with a re-entrant corner. Made with: gmsh -2 -format msh41 bracket.geo
h = 1.5;
Point(1) = {0, 0, 0, h};
Point(2) = {10, 0, 0, h};
Point(3) = {10, 4, 0, h};
Point(4) = {4, 4, 0, h};
Point(5) = {4, 10, 0, h};
Point(6) = {0, 10, 0, h};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5}; Line(5) = {5, 6}; Line(6) = {6, 1};
Curve Loop(1) = {1:6};
Plane Surface(1) = {1};
Physical Curve("bottom") = {1}; Physical Curve("right") = {2}; Physical Curve("arm") = {5}; Physical Curve("left") = {6};
Physical Surface("bracket") = {1};
Mesh.ElementOrder = 2;
