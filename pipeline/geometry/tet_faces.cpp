#include "pipeline/geometry/tet_faces.h"

#include <algorithm>

#include "pipeline/base/error.h"

namespace periost {
namespace {

// A face by its other two corners, filed under its smallest one.
struct FiledFace {
  Index middle = 0, largest = 0;
  Index side = 0;  // 4 * tet + k; fewer than 2^30 tetrahedra
};

Triangle sorted_face(const Tetrahedron& tet, int k) {
  const auto [a, b, c] = face_of(tet, k);
  const Index low = std::min(a, b), high = std::max(a, b);
  return {std::min(low, c), std::max(low, std::min(high, c)), std::max(high, c)};
}

// Faces grouped by their smallest corner: a counting sort, then small sorts.
struct FaceFile {
  std::vector<std::size_t> first;  // per point
  std::vector<FiledFace> faces;
};

FaceFile file_faces(const std::vector<Tetrahedron>& tets, std::size_t points) {
  FaceFile file;
  file.first.assign(points + 1, 0);
  for (const Tetrahedron& tet : tets) {
    for (int k = 0; k < 4; ++k) ++file.first[sorted_face(tet, k)[0] + 1];
  }
  for (std::size_t p = 0; p < points; ++p) file.first[p + 1] += file.first[p];
  file.faces.resize(4 * tets.size());
  std::vector<std::size_t> next(file.first.begin(), file.first.end() - 1);
  for (Index t = 0; t < tets.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const Triangle face = sorted_face(tets[t], k);
      file.faces[next[face[0]]++] = {face[1], face[2], 4 * t + static_cast<Index>(k)};
    }
  }
  return file;
}

void rematch(std::vector<FiledFace>::iterator begin, std::vector<FiledFace>::iterator end,
             std::vector<TetNeighbours>& neighbours) {
  std::sort(begin, end, [](const FiledFace& a, const FiledFace& b) {
    return a.middle != b.middle     ? a.middle < b.middle
           : a.largest != b.largest ? a.largest < b.largest
                                    : a.side < b.side;
  });
  while (begin != end) {
    auto next = begin;
    while (next != end && next->middle == begin->middle && next->largest == begin->largest) ++next;
    if (next - begin == 2) {
      const Index a = begin->side, b = (begin + 1)->side;
      neighbours[a / 4][a % 4] = b / 4;
      neighbours[b / 4][b % 4] = a / 4;
    }
    begin = next;
  }
}

// The nodes in the middle of edges, filed under the edge's smaller end.
class EdgeNodes {
 public:
  explicit EdgeNodes(TetMesh& mesh) : mesh_(mesh), of_point_(mesh.points.size()) {}

  Index between(Index a, Index b) {
    if (a > b) std::swap(a, b);
    for (const auto& [other, node] : of_point_[a]) {
      if (other == b) return node;
    }
    const auto node = static_cast<Index>(mesh_.points.size());
    mesh_.points.push_back(0.5 * (mesh_.points[a] + mesh_.points[b]));
    for (auto& [name, values] : mesh_.point_fields) values.push_back(0.5F * (values[a] + values[b]));
    of_point_[a].emplace_back(b, node);
    return node;
  }

 private:
  TetMesh& mesh_;
  std::vector<std::vector<std::pair<Index, Index>>> of_point_;
};

}  // namespace

std::vector<TetNeighbours> tet_neighbours(const std::vector<Tetrahedron>& tets, std::size_t points) {
  PERIOST_ASSERT(tets.size() < kNoIndex / 4);
  std::vector<TetNeighbours> neighbours(tets.size(), {kNoIndex, kNoIndex, kNoIndex, kNoIndex});
  FaceFile file = file_faces(tets, points);
  for (std::size_t p = 0; p < points; ++p) {
    rematch(file.faces.begin() + static_cast<std::ptrdiff_t>(file.first[p]),
            file.faces.begin() + static_cast<std::ptrdiff_t>(file.first[p + 1]), neighbours);
  }
  return neighbours;
}

std::vector<BoundaryFace> boundary_faces(const std::vector<TetNeighbours>& neighbours) {
  std::vector<BoundaryFace> faces;
  for (Index t = 0; t < neighbours.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      if (neighbours[t][static_cast<std::size_t>(k)] == kNoIndex) faces.push_back({t, k});
    }
  }
  return faces;
}

std::vector<Triangle> faces_between_regions(const TetMesh& mesh,
                                            const std::vector<TetNeighbours>& neighbours) {
  std::vector<Triangle> faces;
  for (std::size_t t = 0; t < mesh.region.size(); ++t) {
    for (int k = 0; k < 4; ++k) {
      const Index other = neighbours[t][static_cast<std::size_t>(k)];
      if (other != kNoIndex && mesh.region[t] < mesh.region[other]) faces.push_back(face_of(mesh.tets[t], k));
    }
  }
  return faces;
}

std::vector<std::uint32_t> tet_components(const std::vector<TetNeighbours>& neighbours) {
  std::vector<std::uint32_t> component(neighbours.size(), kNoIndex);
  std::vector<Index> open;
  std::uint32_t count = 0;
  for (Index start = 0; start < neighbours.size(); ++start) {
    if (component[start] != kNoIndex) continue;
    component[start] = count;
    open.push_back(start);
    while (!open.empty()) {
      const Index tet = open.back();
      open.pop_back();
      for (const Index other : neighbours[tet]) {
        if (other == kNoIndex || component[other] != kNoIndex) continue;
        component[other] = count;
        open.push_back(other);
      }
    }
    ++count;
  }
  return component;
}

void add_midside_nodes(TetMesh& mesh) {
  if (mesh.order() == 2) {
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      for (std::size_t k = 0; k < 6; ++k) {
        const Index a = mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][0])];
        const Index b = mesh.tets[t][static_cast<std::size_t>(kTetEdge[k][1])];
        mesh.points[mesh.midside[t][k]] = 0.5 * (mesh.points[a] + mesh.points[b]);
      }
    }
    return;
  }
  EdgeNodes nodes(mesh);
  mesh.midside.reserve(mesh.tets.size());
  for (const Tetrahedron& tet : mesh.tets) {
    MidsideNodes middle;
    for (std::size_t k = 0; k < 6; ++k) {
      middle[k] = nodes.between(tet[static_cast<std::size_t>(kTetEdge[k][0])],
                                tet[static_cast<std::size_t>(kTetEdge[k][1])]);
    }
    mesh.midside.push_back(middle);
  }
}

}  // namespace periost
