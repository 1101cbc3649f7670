#pragma once
// What every valid mesh must show: it reproduces a uniform stress, and its bodies move in six ways each.
#include <gtest/gtest.h>

#include <array>

#include "pipeline/geometry/tet_faces.h"
#include "pipeline/mechanics/patch_test.h"
#include "pipeline/mechanics/rigid_modes.h"

namespace periost::test {

// The mesh as it is, if of second order with its own mid-side nodes, and its corners at both orders.
inline void expect_fit_for_mechanics(const TetMesh& mesh) {
  TetMesh first = mesh;
  first.midside.clear();
  TetMesh second = first;
  add_midside_nodes(second);
  const std::array<const TetMesh*, 3> meshes{&first, &second, &mesh};
  for (const TetMesh* each : meshes) {
    SCOPED_TRACE(each == &mesh ? "as given" : each == &first ? "first order" : "second order");
    const Stiffness stiffness = assemble_stiffness(*each, Material{}, {});
    EXPECT_LE(patch_test(*each, stiffness, {}).error, 1e-9);
    const RigidModes modes = rigid_modes(*each, stiffness, {});
    EXPECT_EQ(modes.count, 6 * modes.bodies);
    EXPECT_LE(modes.error, 1e-10);
  }
}

}  // namespace periost::test
