// Space frame: two columns, a girder between their tops, and an outrigger from its middle.
DefineConstant[
  cells = {4, Min 1, Step 1, Name "cells"}
];
Point(1) = {0, 0, 0};
Point(2) = {0, 0, 3};
Point(3) = {2, 0, 3};
Point(4) = {4, 0, 3};
Point(5) = {4, 0, 0};
Point(6) = {2, 2, 3};
Line(1) = {1, 2};
Line(2) = {2, 3};
Line(3) = {3, 4};
Line(4) = {5, 4};
Line(5) = {3, 6};
Transfinite Curve {1:5} = cells + 1;
Physical Curve("columns") = {1, 4};
Physical Curve("girder") = {2, 3};
Physical Curve("outrigger") = {5};
Physical Point("left foot") = {1};
Physical Point("right foot") = {5};
Physical Point("left corner") = {2};
Physical Point("right corner") = {4};
Physical Point("middle") = {3};
Physical Point("end") = {6};
