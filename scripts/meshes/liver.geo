// Liver-like solid for the haptic simulation.
//
// Lengths are in metres. Axes: x from the patient's right (large lobe) to the
// left (thin lobe), y up (diaphragmatic dome), z to the front (sharp edge).
//
// Two fused ellipsoids make the lobes; a big sphere from below cuts the concave
// visceral under-surface and another one from behind cuts the posterior surface,
// where the organ is attached to the diaphragm. `make_liver` runs this file and
// sets the meshing parameters with -setnumber.

DefineConstant[
  surface_size = 0.01623    // edge length wanted on the skin
  inner_size = 0.00796      // edge length wanted deep inside
  skin_depth = 0.01106      // depth down to which the surface size holds
  transition_depth = 0.0202 // depth at which the inner size is reached
  algorithm_2d = 6
  algorithm_3d = 1
  perturbation = 1e-4       // relative, of the points while they are meshed
  optimize_threshold = 0.65 // improve the tetrahedra of a lower quality

  right_x = -0.0155 right_y = -0.0165 right_z = 0.0005
  right_rx = 0.094  right_ry = 0.089  right_rz = 0.0915

  left_x = 0.024    left_y = 0.008    left_z = -0.003
  left_rx = 0.092   left_ry = 0.052   left_rz = 0.0755

  lobes_pitch = 29.5  // degrees about x; lowers the front

  // Visceral cutter: a sphere through this point of the under-surface, which
  // there faces along the direction. It leaves the lobes at about their widest,
  // so that nothing bulges past the front edge, and its curvature makes that
  // edge sharp.
  visceral_radius = 0.166
  visceral_x = 0.0            visceral_y = 0.021           visceral_z = -0.01
  visceral_direction_x = 0.37 visceral_direction_y = -0.74 visceral_direction_z = -0.17

  // Posterior cutter: a sphere through this point, from behind.
  posterior_radius = 0.20
  posterior_x = -0.03         posterior_y = 0.01           posterior_z = -0.0665
];

SetFactory("OpenCASCADE");

// A unit sphere whose parametrisation has its poles near +-x, tilted about z,
// and its seam underneath, so that these are cut away as far as possible: they
// would force short edges into the skin.
Macro TurnedSphere
  Sphere(body) = {0, 0, 0, 1};
  Rotate { {0, 1, 0}, {0, 0, 0}, Pi/2 } { Volume{body}; }
  Rotate { {1, 0, 0}, {0, 0, 0}, -Pi/2 } { Volume{body}; }
  Rotate { {0, 0, 1}, {0, 0, 0}, pole_tilt } { Volume{body}; }
Return

right_lobe = 1;
body = right_lobe;
pole_tilt = 0;
Call TurnedSphere;
Dilate { {0, 0, 0}, {right_rx, right_ry, right_rz} } { Volume{right_lobe}; }
Translate { right_x, right_y, right_z } { Volume{right_lobe}; }

left_lobe = 2;
body = left_lobe;
pole_tilt = -Pi/5;
Call TurnedSphere;
Dilate { {0, 0, 0}, {left_rx, left_ry, left_rz} } { Volume{left_lobe}; }
Translate { left_x, left_y, left_z } { Volume{left_lobe}; }

visceral_cutter = 3;
step = visceral_radius / Sqrt(
  visceral_direction_x^2 + visceral_direction_y^2 + visceral_direction_z^2);
Sphere(visceral_cutter) = { visceral_x + step * visceral_direction_x,
                            visceral_y + step * visceral_direction_y,
                            visceral_z + step * visceral_direction_z, visceral_radius };

posterior_cutter = 4;
Sphere(posterior_cutter) = { posterior_x, posterior_y, posterior_z - posterior_radius,
                             posterior_radius };
Rotate { {1, 0, 0}, {posterior_x, posterior_y, posterior_z - posterior_radius}, Pi/2 } {
  Volume{posterior_cutter};
}

lobes = 5;
BooleanUnion(lobes) = { Volume{right_lobe}; Delete; }{ Volume{left_lobe}; Delete; };
Rotate { {1, 0, 0}, {0, 0, 0}, lobes_pitch * Pi / 180 } { Volume{lobes}; }
liver = 6;
BooleanDifference(liver) = { Volume{lobes}; Delete; }{
  Volume{visceral_cutter, posterior_cutter}; Delete;
};

skin() = Boundary{ Volume{liver}; };
Physical Volume("liver", 1) = {liver};
attachment() = Surface In BoundingBox {
  posterior_x - 0.1, posterior_y - 0.1, posterior_z - 0.03,
  posterior_x + 0.1, posterior_y + 0.1, posterior_z + 0.02
};
Physical Surface("surface", 2) = {skin()};
Physical Surface("attachment", 3) = {attachment()};

Field[1] = Distance;
Field[1].SurfacesList = {skin()};
Field[2] = Threshold;
Field[2].InField = 1;
Field[2].SizeMin = surface_size;
Field[2].SizeMax = inner_size;
Field[2].DistMin = skin_depth;
Field[2].DistMax = transition_depth;
Background Field = 2;

Mesh.MeshSizeFromPoints = 0;
Mesh.MeshSizeFromCurvature = 0;
Mesh.MeshSizeExtendFromBoundary = 0;
Mesh.Algorithm = algorithm_2d;
Mesh.Algorithm3D = algorithm_3d;
Mesh.RandomSeed = 1;
Mesh.RandomFactor = perturbation;
Mesh.Optimize = 1;
Mesh.OptimizeThreshold = optimize_threshold;
Mesh.SaveAll = 0;
Mesh.Binary = 0;
Mesh.MshFileVersion = 4.1;
