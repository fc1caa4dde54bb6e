// Section of a roller of radius 10 with its center at (0, 10). Made with: gmsh -2 -format msh41 roller.geo
Point(1) = {0, 10, 0, 2};
Point(2) = {10, 10, 0, 0.3};
Point(3) = {0, 20, 0, 0.3};
Point(4) = {-10, 10, 0, 0.3};
Point(5) = {0, 0, 0, 0.3};
Circle(1) = {2, 1, 3};
Circle(2) = {3, 1, 4};
Circle(3) = {4, 1, 5};
Circle(4) = {5, 1, 2};
Curve Loop(1) = {1:4};
Plane Surface(1) = {1};
Point{1} In Surface {1};
Mesh.Algorithm = 8;
Mesh.RecombineAll = 1;
Physical Curve("rim") = {1:4};
Physical Surface("roller") = {1};
