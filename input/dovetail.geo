// A dovetail blade root of 30 mm in its slot of a disc, in mm: half of both, from the middle (x = 0) to the side of a sector of twelve
// degrees. The axis of the disc is parallel to z through (0, -280).
// Made with: gmsh -3 -format msh41 dovetail.geo
SetFactory("OpenCASCADE");
half = 6*Pi/180; axis = -280; rim = 24; bore = -60;
w = Sqrt(0.5); q = Tan(22.5*Pi/180);
R = 8;           // radius of the disc at the upper end of its flank
r = 2;           // of the slot below the flank
b = 3;           // of the slot's bottom corner
f = 3;           // of the fillet at the blade's neck
c = 2;           // of the corner below the blade's flank
// The flank of the disc is on x + y = 29.
Point(1) = {0, bore, 0};                            Point(2) = {(bore - axis)*Tan(half), bore, 0};
Point(3) = {(rim - axis)*Tan(half), rim, 0};        Point(4) = {10 + 5*w + R*w - R, rim, 0};
Point(5) = {10 + 5*w + R*w - R, 19 - 5*w + R*w, 0}; Point(6) = {10 + 5*w + R*w, 19 - 5*w + R*w, 0};
Point(7) = {10 + 5*w, 19 - 5*w, 0};                 Point(8) = {21 - r*q*w, 8 + r*q*w, 0};
Point(9) = {21 - r, 8 - r*q, 0};                    Point(10) = {21, 8 - r*q, 0};
Point(11) = {21, b - 3, 0};                         Point(12) = {21 - b, b - 3, 0};
Point(13) = {21 - b, -3, 0};                        Point(14) = {0, -3, 0};
Line(1) = {1, 2}; Line(2) = {2, 3}; Line(3) = {3, 4}; Line(4) = {4, 5};
Circle(5) = {5, 6, 7}; Line(6) = {7, 8}; Circle(7) = {8, 9, 10};
Line(8) = {10, 11}; Circle(9) = {11, 12, 13}; Line(10) = {13, 14}; Line(11) = {14, 1};
Curve Loop(1) = {1:11};
Plane Surface(1) = {1};
disc[] = Extrude {0, 0, 30} { Surface{1}; };
// The root has some play.
d = -0.03;
Point(101) = {0, d, 0};                             Point(102) = {13, d, 0};
Point(103) = {19, 5 + d, 0};                        Point(104) = {19, 10 - c*q + d, 0};
Point(105) = {19 - c, 10 - c*q + d, 0};             Point(106) = {19 - c*q*w, 10 + c*q*w + d, 0};
Point(112) = {10 + 4*w, 19 - 4*w + d, 0};           // a little beyond the end of the disc's flank
Point(107) = {10 + f*q*w, 19 - f*q*w + d, 0};       Point(108) = {10 + f, 19 + f*q + d, 0};
Point(109) = {10, 19 + f*q + d, 0};                 Point(110) = {10, 35, 0};
Point(111) = {0, 35, 0};
Line(101) = {101, 102}; Line(102) = {102, 103}; Line(103) = {103, 104}; Circle(104) = {104, 105, 106};
Line(105) = {106, 112}; Line(110) = {112, 107}; Circle(106) = {107, 108, 109}; Line(107) = {109, 110}; Line(108) = {110, 111}; Line(109) = {111, 101};
Curve Loop(101) = {101:105, 110, 106:109};
Plane Surface(101) = {101};
blade[] = Extrude {0, 0, 30} { Surface{101}; };
e = 0.001;
Physical Volume("disc") = {disc[1]};
Physical Volume("blade") = {blade[1]};
Physical Surface("slot") = {disc[6], disc[7]};          // flank and its rounded end
Physical Surface("side") = {disc[3]};
Physical Surface("flank") = {blade[6]};
Physical Surface("top") = {blade[10]};
Physical Surface("middle") = Surface In BoundingBox {-e, bore - e, -e, e, 35 + e, 30 + e};
Mesh.MeshSizeMax = 20;
Mesh.MeshSizeFromCurvature = 8;
MeshSize{ PointsOf{ Surface{blade[6]}; } } = 2.7;
MeshSize{ PointsOf{ Surface{disc[6], disc[7]}; } } = 3.6;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 2;
