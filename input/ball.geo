// A quarter of the lower half of a ball of radius 10 in mm, its pole at the origin, finest there; its sole is a cap of it.
// Made with: gmsh -3 -format msh41 ball.geo
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 10, 10, -Pi/2, 0, Pi/2};
Circle(20) = {0, 0, 1, 0.6, 0, Pi/2};
Extrude {0, 0, -1.5} { Curve{20}; }
BooleanFragments{ Volume{1}; Delete; }{ Surface{5}; Delete; }
e = 0.001;
Physical Volume("ball") = Volume In BoundingBox {-e, -e, -e, 10 + e, 10 + e, 10 + e};
Physical Surface("sole") = Surface In BoundingBox {-e, -e, -e, 0.6 + e, 0.6 + e, 0.1};
Physical Surface("equator") = Surface In BoundingBox {-e, -e, 10 - e, 10 + e, 10 + e, 10 + e};
Physical Surface("x") = Surface In BoundingBox {-e, -e, -e, e, 10 + e, 10 + e};
Physical Surface("y") = Surface In BoundingBox {-e, -e, -e, 10 + e, e, 10 + e};
Field[1] = MathEval;
Field[1].F = "0.07 + 0.45*0.5*(Sqrt(x*x+y*y+z*z) - 0.3 + Abs(Sqrt(x*x+y*y+z*z) - 0.3))";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 2;
