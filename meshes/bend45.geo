// 45 degree bend: arc of radius 100 in the xy plane, from the origin along +x towards +y.
DefineConstant[
  cells = {8, Min 1, Step 1, Name "cells"},
  radius = {100, Name "radius"}
];
Point(1) = {0, 0, 0};
Point(2) = {0, radius, 0};
Point(3) = {radius * Sin(Pi / 4), radius * (1 - Cos(Pi / 4)), 0};
Circle(1) = {1, 2, 3};
Transfinite Curve {1} = cells + 1;
Physical Curve("arc") = {1};
Physical Point("clamp") = {1};
Physical Point("tip") = {3};
