// A lug of 40 x 30 x 32 mm: a foot of 8 mm, a wall of 10 mm with a bore of 12 mm and rounded shoulders, fillets of 5 mm at its foot.
// Made with: gmsh -3 -format msh41 solid_lug.geo
SetFactory("OpenCASCADE");
Box(1) = {-20, -15, 0, 40, 30, 8};
Box(2) = {-5, -15, 8, 10, 30, 24};
BooleanUnion(3) = { Volume{1}; Delete; }{ Volume{2}; Delete; };
foot[] = Curve In BoundingBox {-5.01, -15.01, 7.99, -4.99, 15.01, 8.01};
foot[] += Curve In BoundingBox {4.99, -15.01, 7.99, 5.01, 15.01, 8.01};
shoulders[] = Curve In BoundingBox {-5.01, -15.01, 31.99, 5.01, -14.99, 32.01};
shoulders[] += Curve In BoundingBox {-5.01, 14.99, 31.99, 5.01, 15.01, 32.01};
lug[] = Fillet{3}{foot[], shoulders[]}{5, 5, 10, 10};
Cylinder(90) = {-6, 0, 20, 12, 0, 0, 6};
BooleanDifference(91) = { Volume{lug[0]}; Delete; }{ Volume{90}; Delete; };
Physical Volume("lug") = {91};
Physical Surface("sole") = Surface In BoundingBox {-20.01, -15.01, -0.01, 20.01, 15.01, 0.01};
Physical Surface("bore") = Surface In BoundingBox {-5.01, -6.01, 13.99, 5.01, 6.01, 26.01};
Mesh.MeshSizeMax = 9;
Mesh.MeshSizeFromCurvature = 8;
Mesh.ElementOrder = 2;
Mesh.HighOrderOptimize = 2;
