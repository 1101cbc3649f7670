#pragma once
// Small stages for tests of the framework, which must not depend on the real ones.
#include "pipeline/stage/registry.h"

namespace periost::sample {

// read (path -> image), mesh (image, optional mask -> closed surface), open_mesh (image -> surface),
// tets (closed surface -> tet_mesh), compare (surface and reference surface -> quality), twins (image -> two
// surfaces).
void register_stages(Registry& registry);

}  // namespace periost::sample
