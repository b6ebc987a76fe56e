// A quarter of a hemisphere with an 18 degree hole at the pole: cells x cells quadrilaterals.
// A meridian turned about z, so the mesh is a grid of meridians and parallels; normals outward.
DefineConstant[
  cells = {16, Min 1, Step 1, Name "cells"},
  radius = {10, Name "radius"}
];
hole = 18 * Pi / 180;
Point(1) = {0, 0, 0};
Point(2) = {0, radius, 0};
Point(3) = {0, radius * Sin(hole), radius * Cos(hole)};
Circle(1) = {2, 1, 3};
Transfinite Curve {1} = cells + 1;
turned[] = Extrude {{0, 0, 1}, {0, 0, 0}, -Pi / 2} {
  Curve{1}; Layers{cells}; Recombine;
};
ends[] = Boundary{ Curve{turned[0]}; };
Physical Surface("shell") = {turned[1]};
Physical Curve("a=0") = {turned[0]};
Physical Curve("a=1") = {1};
Physical Point("00") = {ends[0]};
Physical Point("10") = {2};
