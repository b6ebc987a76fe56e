// Mid-surfaces of an I-beam along x, height z: two flanges of two halves each, and a web.
DefineConstant[ length = 2, height = 0.2, width = 0.1, along = 40, across = 3, deep = 8 ];

For end In {0 : 1}
  For level In {0 : 1}
    For side In {0 : 2}
      Point(1 + 10 * end + 3 * level + side) =
        {end * length, (side - 1) * width / 2, (level - 1 / 2) * height};
    EndFor
  EndFor
  Line(1 + 10 * end) = {1 + 10 * end, 2 + 10 * end};
  Line(2 + 10 * end) = {2 + 10 * end, 3 + 10 * end};
  Line(3 + 10 * end) = {4 + 10 * end, 5 + 10 * end};
  Line(4 + 10 * end) = {5 + 10 * end, 6 + 10 * end};
  Line(5 + 10 * end) = {2 + 10 * end, 5 + 10 * end};
  Transfinite Curve{1 + 10 * end : 4 + 10 * end} = across + 1;
  Transfinite Curve{5 + 10 * end} = deep + 1;
EndFor
For i In {1 : 6}
  Line(20 + i) = {i, 10 + i};
EndFor
Transfinite Curve{21 : 26} = along + 1;

// the two halves of a flange have one orientation: it goes on through the branch
Curve Loop(1) = {21, 11, -22, -1};  Plane Surface(1) = {1};
Curve Loop(2) = {22, 12, -23, -2};  Plane Surface(2) = {2};
Curve Loop(3) = {24, 13, -25, -3};  Plane Surface(3) = {3};
Curve Loop(4) = {25, 14, -26, -4};  Plane Surface(4) = {4};
Curve Loop(5) = {22, 15, -25, -5};  Plane Surface(5) = {5};
Transfinite Surface{1 : 5};
Recombine Surface{1 : 5};

Physical Surface("flanges") = {1, 2, 3, 4};
Physical Surface("web") = {5};
Physical Curve("root") = {1, 2, 3, 4, 5};
Physical Curve("web end") = {15};
Physical Curve("bottom end") = {11, 12};
Physical Curve("top end") = {13, 14};
Physical Point("bottom") = {12};
Physical Point("top") = {15};
