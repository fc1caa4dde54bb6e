// A block of 2 by 1 by 1 in two halves; the right one is the extrusion of the face between them.
DefineConstant[ shape = 4, degree = 1 ];
Point(1) = {0, 0, 0, 1};
Point(2) = {1, 0, 0, 1};
Point(3) = {1, 1, 0, 1};
Point(4) = {0, 1, 0, 1};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
If (shape == 8)
   Transfinite Curve{1:4} = 2;
   Transfinite Surface{1};
   Recombine Surface{1};
   first[] = Extrude {0, 0, 1} { Surface{1}; Layers{2}; Recombine; };
   second[] = Extrude {1, 0, 0} { Surface{first[3]}; Layers{1}; Recombine; };
Else
   first[] = Extrude {0, 0, 1} { Surface{1}; };
   second[] = Extrude {1, 0, 0} { Surface{first[3]}; };
EndIf
Physical Volume("body", 1) = {first[1], second[1]};
Physical Volume("left half", 2) = {first[1]};
bottom() = Surface In BoundingBox {-0.1, -0.1, -0.1, 2.1, 1.1, 0.1};
end() = Surface In BoundingBox {1.9, -0.1, -0.1, 2.1, 1.1, 1.1};
top() = Surface In BoundingBox {-0.1, -0.1, 0.9, 2.1, 1.1, 1.1};
Physical Surface("bottom", 10) = {bottom()};
Physical Surface("right end", 11) = {end()};
Physical Surface("middle", 12) = {first[3]};
Physical Surface(40) = {top()};
edge() = Curve In BoundingBox {-0.1, -0.1, -0.1, 2.1, 0.1, 0.1};
Physical Curve("edge", 20) = {edge()};
corners() = Point In BoundingBox {-0.1, -0.1, -0.1, 0.1, 0.1, 1.1};
Physical Point("corners", 30) = {corners()};
Mesh.ElementOrder = degree;
Mesh.SecondOrderIncomplete = 1;
