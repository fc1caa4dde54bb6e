// Quarters of the halves of two balls that touch at the origin, of radii 10 above and 20 below in mm, finest there; the caps of
// both that may touch are sets.
// Made with: gmsh -3 -format msh41 balls.geo
SetFactory("OpenCASCADE");
Sphere(1) = {0, 0, 10, 10, -Pi/2, 0, Pi/2};
// The faces of the meshes would overlap at the pole by 0.00014.
Sphere(2) = {0, 0, -20.0002, 20, 0, Pi/2, Pi/2};
Circle(90) = {0, 0, 1, 0.6, 0, Pi/2};
cut[] = Extrude {0, 0, -2} { Curve{90}; };
BooleanFragments{ Volume{1}; Delete; }{ Surface{cut[1]}; }
BooleanFragments{ Volume{2}; Delete; }{ Surface{cut[1]}; Delete; }
e = 0.001;
Physical Volume("upper") = Volume In BoundingBox {-e, -e, -e, 10 + e, 10 + e, 10 + e};
Physical Volume("lower") = Volume In BoundingBox {-e, -e, -20 - e, 20 + e, 20 + e, e};
Physical Surface("upper cap") = Surface In BoundingBox {-e, -e, -e, 0.6 + e, 0.6 + e, 0.1};
Physical Surface("lower cap") = Surface In BoundingBox {-e, -e, -0.1, 0.6 + e, 0.6 + e, e};
Physical Surface("top") = Surface In BoundingBox {-e, -e, 10 - e, 10 + e, 10 + e, 10 + e};
Physical Surface("bottom") = Surface In BoundingBox {-e, -e, -20 - e, 20 + e, 20 + e, -20 + e};
Physical Surface("x") = Surface In BoundingBox {-e, -e, -20 - e, e, 20 + e, 10 + e};
Physical Surface("y") = Surface In BoundingBox {-e, -e, -20 - e, 20 + e, e, 10 + e};
Field[1] = MathEval;
Field[1].F = "0.09 + 0.66*0.5*(Sqrt(x*x+y*y+z*z) - 0.36 + Abs(Sqrt(x*x+y*y+z*z) - 0.36))";
Background Field = 1;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.MeshSizeFromPoints = 0;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 2;
