// A sixteenth of two pipe flanges with eight bolts M16, in mm: from the plane y = 0 through a bolt to the plane midway to the next
// one. The flanges meet at z = 0, the bolt is cut at z = 10.
// Made with: gmsh -3 -format msh41 pipe_flange.geo
SetFactory("OpenCASCADE");
half = 22.5*Pi/180;
bore = 40; pipe = 47; rim = 92; circle = 71; end = 52;
upper = 20; lower = -24;
r = 6;           // of the fillets
e = 0.001;
For i In {0:1}
  s = 1 - 2*i;   // above, below
  t = s > 0 ? upper : lower;
  n = 1000*i + 1;
  Point(n) = {bore, 0, 0};            Point(n + 1) = {rim, 0, 0};      Point(n + 2) = {rim, 0, t};
  Point(n + 3) = {pipe + r, 0, t};    Point(n + 4) = {pipe + r, 0, t + s*r};
  Point(n + 5) = {pipe, 0, t + s*r};  Point(n + 6) = {pipe, 0, s*end}; Point(n + 7) = {bore, 0, s*end};
  Line(n) = {n, n + 1}; Line(n + 1) = {n + 1, n + 2}; Line(n + 2) = {n + 2, n + 3};
  Circle(n + 3) = {n + 3, n + 4, n + 5};
  Line(n + 4) = {n + 5, n + 6}; Line(n + 5) = {n + 6, n + 7}; Line(n + 6) = {n + 7, n};
  Curve Loop(n) = {n:n + 6};
  Plane Surface(n) = {n};
  flange[] = Extrude {{0, 0, 1}, {0, 0, 0}, half} { Surface{n}; };
  hole = newv; Cylinder(hole) = {circle, 0, -30, 0, 0, 60, 9};
  volume~{i}[] = BooleanDifference{ Volume{flange[1]}; Delete; }{ Volume{hole}; Delete; };
  face~{i}[] = Surface In BoundingBox {-e, -e, -e, rim + e, rim, e};
EndFor
face_1[] -= face_0[];
// The bolt's head above the cut, its nut below it.
Cylinder(91) = {circle, 0, 10, 0, 0, upper - 10, 8, Pi};
Cylinder(92) = {circle, 0, upper, 0, 0, 10, 13, Pi};
head[] = BooleanUnion{ Volume{91}; Delete; }{ Volume{92}; Delete; };
cut_0[] = Surface In BoundingBox {circle - 8 - e, -e, 10 - e, circle + 8 + e, 8 + e, 10 + e};
seat_0[] = Surface In BoundingBox {circle - 13 - e, -e, upper - e, circle + 13 + e, 13 + e, upper + e};
Cylinder(93) = {circle, 0, lower, 0, 0, 10 - lower, 8, Pi};
Cylinder(94) = {circle, 0, lower - 13, 0, 0, 13, 13, Pi};
nut[] = BooleanUnion{ Volume{93}; Delete; }{ Volume{94}; Delete; };
cut_1[] = Surface In BoundingBox {circle - 8 - e, -e, 10 - e, circle + 8 + e, 8 + e, 10 + e};
cut_1[] -= cut_0[];
seat_1[] = Surface In BoundingBox {circle - 13 - e, -e, lower - e, circle + 13 + e, 13 + e, lower + e};
back_0[] = Surface In BoundingBox {-e, -e, upper - e, rim + e, rim, upper + e};
back_0[] -= seat_0[];
back_1[] = Surface In BoundingBox {-e, -e, lower - e, rim + e, rim, lower + e};
back_1[] -= seat_1[];
Physical Volume("upper") = volume_0[];
Physical Volume("lower") = volume_1[];
Physical Volume("head") = head[];
Physical Volume("nut") = nut[];
Physical Surface("upper face") = face_0[];
Physical Surface("lower face") = face_1[];
Physical Surface("upper back") = back_0[];
Physical Surface("lower back") = back_1[];
Physical Surface("head seat") = seat_0[];
Physical Surface("nut seat") = seat_1[];
Physical Surface("head cut") = cut_0[];
Physical Surface("nut cut") = cut_1[];
Physical Surface("bore") = Surface In BoundingBox {-e, -e, -end - e, bore + e, 16, end + e};
Physical Surface("upper end") = Surface In BoundingBox {-e, -e, end - e, rim, rim, end + e};
Physical Surface("lower end") = Surface In BoundingBox {-e, -e, -end - e, rim, rim, -end + e};
Physical Surface("through bolt") = Surface In BoundingBox {-e, -e, -end - e, rim + e, e, end + e};
Physical Surface("midway") = Surface In BoundingBox {-e, bore*Sin(half) - e, -end - e, rim + e, rim, end + e};
Mesh.MeshSizeMax = 14;
MeshSize{ PointsOf{ Volume{head[], nut[]}; } } = 5;
MeshSize{ PointsOf{ Surface{face_0[]}; } } = 6;
Mesh.MeshSizeFromCurvature = 7;
Mesh.ElementOrder = 2;
