// Tetrahedra of second order in the bracket, whose STEP file is in millimetres.
DefineConstant[ size = 0.012 ];
Geometry.OCCScaling = 1e-3;
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromCurvature = 12;
Mesh.ElementOrder = 2;
Merge "bracket.step";
