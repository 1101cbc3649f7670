#pragma once
// Memory asked for ahead of its use. Vertices and triangles of the isosurface are numbered along one curve,
// so all that moves at a run of vertices read lies in a few runs of memory; fetched one after the other these
// cost less than when every move waits for its own.
#include "stages/decimate/certified_moves.h"

namespace periost {

// Has what moves at vertices `first` to `last` read on its way to the cache. Changes nothing.
void fetch_ahead(const CertifiedState& state, const Worker& worker, Index first, Index last);

}  // namespace periost
