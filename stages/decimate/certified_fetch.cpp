#include "stages/decimate/certified_fetch.h"

#include <algorithm>

namespace periost {
namespace {

constexpr std::size_t kLine = 64;  // bytes
constexpr Index kTrianglesPerVertex =
    30;  // of the isosurface, at most: longer runs are not near the vertices

template <class T>
void fetch(const std::vector<T>& list, std::size_t first, std::size_t last) {
  if (last >= list.size()) return;
  const char* const end = reinterpret_cast<const char*>(list.data() + last);
  for (const char* line = reinterpret_cast<const char*>(list.data() + first); line <= end; line += kLine) {
    __builtin_prefetch(line);
  }
}

}  // namespace

void fetch_ahead(const CertifiedState& state, const Worker& worker, Index first, Index last) {
  const CertifiedMesh& mesh = state.mesh;
  const auto [from, to] = std::minmax(mesh.nearest[first], mesh.nearest[last]);
  const Index begin = from, end = std::min(to, from + kTrianglesPerVertex * (last - first));
  fetch(state.reference.triangles, begin, end);
  fetch(state.reference.normals, begin, end);
  fetch(mesh.triangles, begin, end);
  fetch(state.proofs.proof, begin, end);
  fetch(state.proofs.next, begin, end);
  fetch(state.proofs.first, begin, end);
  fetch(state.proofs.first_labelled, begin, end);
  fetch(state.failed, 3 * std::size_t{begin}, 3 * std::size_t{end});
  fetch(worker.ring.visit_of, begin, end);
  fetch(worker.sheets.stamp, begin, end);
  fetch(worker.forward.stamp, begin, end);
  fetch(state.reference.points, first, last);
  fetch(mesh.points, first, last);
  fetch(mesh.nearest, first, last);
  fetch(mesh.incident, first, last);
  fetch(mesh.valence, first, last);
  fetch(mesh.version, first, last);
  fetch(state.quadrics, first, last);
  fetch(worker.ring.foot_of, first, last);
  fetch(worker.reverse.known, first, last);
  fetch(worker.reverse.mask, first, last);
  fetch(worker.reverse.stamp, first, last);
}

}  // namespace periost
