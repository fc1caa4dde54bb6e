// One of a row of bolts, 30 mm apart, through a plate and the straps above and below it, in mm: what is above the middle of the
// plate and beside the middle of the bolt. The bolt has 1 mm of clearance.
// Made with: gmsh -3 -format msh41 bolted_joint.geo
SetFactory("OpenCASCADE");
Box(1) = {-45, 0, 0, 60, 15, 5};
Box(2) = {-15, 0, 5, 60, 15, 6};
Cylinder(3) = {0, 0, -1, 0, 0, 20, 5.5};
BooleanDifference{ Volume{1}; Delete; }{ Volume{3}; }
BooleanDifference{ Volume{2}; Delete; }{ Volume{3}; Delete; }
Cylinder(4) = {0, 0, 0, 0, 0, 11, 5, Pi};
Cylinder(5) = {0, 0, 11, 0, 0, 6, 9, Pi};
BooleanUnion{ Volume{4}; Delete; }{ Volume{5}; Delete; }
e = 0.001;
Physical Volume("plate") = Volume In BoundingBox {-45 - e, -e, -e, 15 + e, 15 + e, 5 + e};
Physical Volume("strap") = Volume In BoundingBox {-15 - e, -e, 5 - e, 45 + e, 15 + e, 11 + e};
Physical Volume("bolt") = Volume In BoundingBox {-9 - e, -e, -e, 9 + e, 9 + e, 17 + e};
Physical Surface("plate top") = Surface In BoundingBox {-45 - e, -e, 5 - e, 15 + e, 15 + e, 5 + e};
Physical Surface("strap bottom") = Surface In BoundingBox {-15 - e, -e, 5 - e, 45 + e, 15 + e, 5 + e};
head[] = Surface In BoundingBox {-9 - e, -e, 11 - e, 9 + e, 9 + e, 11 + e};
top[] = Surface In BoundingBox {-15 - e, -e, 11 - e, 45 + e, 15 + e, 11 + e};
top[] -= head[];
Physical Surface("strap top") = top[];
Physical Surface("head") = head[];
cut[] = Surface In BoundingBox {-5 - e, -e, -e, 5 + e, 5 + e, e};
middle[] = Surface In BoundingBox {-45 - e, -e, -e, 15 + e, 15 + e, e};
middle[] -= cut[];
Physical Surface("middle") = middle[];
Physical Surface("cut") = cut[];
Physical Surface("y") = Surface In BoundingBox {-45 - e, -e, -e, 45 + e, e, 17 + e};
Physical Surface("side") = Surface In BoundingBox {-45 - e, 15 - e, -e, 45 + e, 15 + e, 11 + e};
Physical Surface("left") = Surface In BoundingBox {-45 - e, -e, -e, -45 + e, 15 + e, 5 + e};
Physical Surface("right") = Surface In BoundingBox {45 - e, -e, 5 - e, 45 + e, 15 + e, 11 + e};
Mesh.MeshSizeMax = 7;
Mesh.MeshSizeMin = 2.5;
Field[1] = MathEval;
Field[1].F = "3.4 + 0.12*0.5*(Sqrt(x*x+y*y) - 12 + Abs(Sqrt(x*x+y*y) - 12))";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.ElementOrder = 2;
