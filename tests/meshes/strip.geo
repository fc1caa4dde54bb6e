// A strip of 2 by 1 in two halves, the left one clockwise. -setnumber shape 3: triangles, 4: quadrilaterals, 7: both.
DefineConstant[ shape = 3, degree = 1, has_centers = 1 ];
Point(1) = {0, 0, 0};
Point(2) = {1, 0, 0};
Point(3) = {2, 0, 0};
Point(4) = {2, 1, 0};
Point(5) = {1, 1, 0};
Point(6) = {0, 1, 0};
Point(7) = {1, 5, 3}; // belongs to nothing
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {4, 5};
Line(5) = {5, 6};
Line(6) = {6, 1};
Line(7) = {2, 5};
Curve Loop(1) = {-6, -5, -7, -1};
Plane Surface(1) = {1};
Curve Loop(2) = {2, 3, 4, -7};
Plane Surface(2) = {2};
Transfinite Curve {1:7} = 3;
Transfinite Surface {1, 2};
Periodic Curve {3} = {-6} Translate {2, 0, 0};
If (shape == 4)
  Recombine Surface {1, 2};
ElseIf (shape == 7)
  Recombine Surface {2};
EndIf
Mesh.ElementOrder = degree;
Mesh.SecondOrderIncomplete = 1 - has_centers;
Physical Point("corners") = {1, 3};
Physical Point(9) = {7};
Physical Curve("bottom") = {1, 2};
Physical Curve("right end") = {3};
Physical Curve(40) = {-5, 4};
Physical Curve("middle") = {7};
Physical Surface("body") = {1, 2};
Physical Surface("left half") = {1};
