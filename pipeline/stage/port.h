#pragma once
// A port is a typed input or output of a stage, with the mesh properties it requires or guarantees. The plan
// checks them against each other before a voxel is read.
#include <string>

#include "pipeline/data/artefact.h"

namespace periost {

// Properties of a surface. An output with a property promises it; an input with it refuses what does not.
struct SurfaceProperties {
  bool closed = false;
  bool manifold = false;
  bool oriented = false;
};

struct Port {
  std::string name;  // "surface"; unique among a stage's inputs or outputs
  ArtefactKind kind = ArtefactKind::kImage;
  SurfaceProperties properties;
  bool optional = false;  // inputs only: the stage runs without it
  std::string doc;        // one sentence
  bool by_name = false;   // inputs only, optional: connected by `from: {NAME: ID}` and by nothing else
};

}  // namespace periost
