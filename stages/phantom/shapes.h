#pragma once
// The anatomical phantoms as bodies of round cones, scaled to fill a box.
#include <cstdint>

#include "stages/phantom/body.h"

namespace periost {

// Lateral ventricles of a brain, left and right: frontal horn, body, occipital and temporal horns.
Body ventricle_body(Vec3 box_mm);

// A tree of vessels that grows along z, splitting in two with Murray's law for the radii.
Body vessel_body(Vec3 box_mm, std::uint64_t seed);

// A thigh bone along z, its head up: shaft with a bow, neck and head, trochanters, condyles.
struct Femur {
  Body outer;
  double scale = 1;        // mm of the image for one mm of the model
  double half_length = 0;  // mm

  // Thickness of the cortex at height z, mm: thick in the shaft, thin at the ends.
  double cortex_mm(double z) const;
  // Share of trabecular bone in the interior at height z, 0 in the shaft to 1 at the ends.
  double trabecular_share(double z) const;
};
Femur femur(Vec3 box_mm);

}  // namespace periost
