#pragma once
// The surface half of measure_quality.h.
#include "pipeline/geometry/measure_quality.h"

namespace periost {

IsosurfaceQuality measure_isosurface(const SurfaceMesh& isosurface, double voxel_mm);

// Fills the metrics of the surface alone and their worst elements.
SurfaceQuality measure_surface(const SurfaceMesh& surface, const MeasureOptions& options,
                               const Context& context, WorstElements& worst);

// Root mean square, in degrees, of phi - (mean of phi over the three neighbours) over the vertices of the
// dual simplex mesh that have three neighbours, phi the simplex angle at the triangles' centroids: how far
// the surface is from the paper's goal of an evenly spread curvature. Absent when the surface is not an
// oriented manifold. 0 for a regular tiling of a plane or sphere.
std::optional<double> simplex_angle_rms_deg(const SurfaceMesh& surface);

// Root mean square, in degrees, of the angle between the normals of two triangles that share an edge.
// Triangles without area are left out. 0 for a plane.
double normal_deviation_rms_deg(const SurfaceMesh& surface);

}  // namespace periost
