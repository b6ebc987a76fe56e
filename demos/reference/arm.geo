// Quadrilaterals and triangles of second order on the middle surface of the arm.
DefineConstant[ size = 0.012 ];
Geometry.OCCScaling = 1e-3;
Mesh.MeshSizeMax = size;
Mesh.MeshSizeFromCurvature = 12;
Mesh.RecombinationAlgorithm = 0;
Mesh.RecombineAll = 1;
Mesh.ElementOrder = 2;
Merge "arm.step";
