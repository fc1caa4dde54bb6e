// A block of 3 by 2 with cells of any shape. -setnumber shape 3: triangles, 4: quadrilaterals.
DefineConstant[ shape = 3, degree = 1, has_centers = 1 ];
Point(1) = {0, 0, 0, 0.5};
Point(2) = {3, 0, 0, 0.8};
Point(3) = {3, 2, 0, 1.0};
Point(4) = {0, 2, 0, 0.7};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 1};
Curve Loop(1) = {1, 2, 3, 4};
Plane Surface(1) = {1};
If (shape == 4)
  Recombine Surface {1};
EndIf
Mesh.Algorithm = 6;
Mesh.ElementOrder = degree;
Mesh.SecondOrderIncomplete = 1 - has_centers;
Physical Curve("bottom") = {1};
Physical Curve("right") = {2};
Physical Curve("top") = {3};
Physical Curve("left") = {4};
Physical Surface("body") = {1};
