#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <iterator>

#include "pipeline/base/file.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/geometry/topology.h"
#include "pipeline/io/abaqus_deck.h"

namespace periost {
namespace {

constexpr std::size_t kNumberWidth = 20;     // characters of a number that CalculiX reads
constexpr std::size_t kEntriesPerLine = 16;  // numbers on a line that CalculiX reads

constexpr char kHeader[] =
    "** Tetrahedral mesh written by Periost.\n"
    "** Units: mm, N, MPa, tonne (s). Density in tonne/mm^3.\n"
    "** Frame: patient coordinates LPS (x to the left, y to posterior, z to superior), millimetres.\n"
    "** Include it with *INCLUDE and add material, supports and loads; sets are listed in the "
    "documentation.\n";

// The shortest decimal that reads back to `value`, or the nearest one that fits the width.
std::string number(double value) {
  char text[40];
  const auto shortest = std::to_chars(text, text + sizeof text, value);
  std::string result(text, shortest.ptr);
  for (int digits = 16; result.size() > kNumberWidth; --digits) {
    const auto rounded =
        std::to_chars(text, text + sizeof text, value, std::chars_format::scientific, digits);
    result.assign(text, rounded.ptr);
  }
  return result;
}

// Text that goes to the file in large pieces.
class Text {
 public:
  explicit Text(const std::filesystem::path& path) : file_(path) {}

  template <class... Values>
  void add(fmt::format_string<Values...> form, Values&&... values) {
    fmt::format_to(std::back_inserter(buffer_), form, std::forward<Values>(values)...);
    if (buffer_.size() > kPiece) flush();
  }
  void commit() {
    flush();
    file_.commit();
  }

 private:
  static constexpr std::size_t kPiece = std::size_t{1} << 16;
  void flush() {
    file_.write(buffer_.data(), buffer_.size());
    buffer_.clear();
  }
  AtomicFile file_;
  fmt::memory_buffer buffer_;
};

void add_nodes(Text& text, const TetMesh& mesh) {
  text.add("*NODE, NSET=NALL\n");
  for (std::size_t p = 0; p < mesh.points.size(); ++p) {
    const Vec3 point = mesh.points[p];
    text.add("{}, {}, {}, {}\n", p + 1, number(point.x), number(point.y), number(point.z));
  }
}

std::int32_t region_of(const TetMesh& mesh, std::size_t tet) {
  return mesh.region.empty() ? 1 : mesh.region[tet];
}

std::vector<std::int32_t> region_numbers(const TetMesh& mesh) {
  std::vector<std::int32_t> numbers = mesh.region;
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  if (numbers.empty() && !mesh.tets.empty()) numbers.push_back(1);
  return numbers;
}

void add_elements(Text& text, const TetMesh& mesh) {
  const char* type = mesh.order() == 2 ? "C3D10" : "C3D4";
  const std::vector<std::int32_t> regions = region_numbers(mesh);
  for (const std::int32_t region : regions) {
    text.add("*ELEMENT, TYPE={}, ELSET=REGION_{}\n", type, region);
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      if (region_of(mesh, t) != region) continue;
      const auto& [a, b, c, d] = mesh.tets[t];
      text.add("{}, {}, {}, {}, {}", t + 1, a + 1, b + 1, c + 1, d + 1);
      // Abaqus orders mid-side nodes as VTK does: edges 12, 23, 31, 14, 24, 34.
      if (mesh.order() == 2) {
        for (const Index node : mesh.midside[t]) text.add(", {}", node + 1);
      }
      text.add("\n");
    }
  }
  if (regions.empty()) return;
  text.add("*ELSET, ELSET=EALL\n");
  for (const std::int32_t region : regions) text.add("REGION_{}\n", region);
}

void add_node_set(Text& text, const TetMesh& mesh, const std::vector<BoundaryFace>& faces) {
  std::vector<bool> is_on(mesh.points.size(), false);
  for (const BoundaryFace& face : faces) {
    for (int k = 0; k < 4; ++k) {
      if (k != face.opposite) is_on[mesh.tets[face.tet][static_cast<std::size_t>(k)]] = true;
    }
    if (mesh.order() != 2) continue;
    for (std::size_t k = 0; k < 6; ++k) {
      const bool is_in_face = kTetEdge[k][0] != face.opposite && kTetEdge[k][1] != face.opposite;
      if (is_in_face) is_on[mesh.midside[face.tet][k]] = true;
    }
  }
  text.add("*NSET, NSET=NBOUNDARY\n");
  std::size_t written = 0;
  for (std::size_t p = 0; p < is_on.size(); ++p) {
    if (!is_on[p]) continue;
    text.add("{}{}", written % kEntriesPerLine == 0 ? (written == 0 ? "" : ",\n") : ", ", p + 1);
    ++written;
  }
  text.add("\n");
}

// Per face, whether its piece of the boundary surrounds a body (positive volume) or a cavity.
std::vector<bool> is_outer(const TetMesh& mesh, const std::vector<BoundaryFace>& faces) {
  std::vector<Triangle> triangles;
  for (const BoundaryFace& face : faces) triangles.push_back(face_of(mesh.tets[face.tet], face.opposite));
  const std::vector<std::uint32_t> piece = triangle_components(triangles, mesh.points.size());
  std::vector<double> volume;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (piece[f] >= volume.size()) volume.resize(piece[f] + 1, 0.0);
    const Vec3 origin = mesh.points[triangles[0][0]];
    const auto& [a, b, c] = triangles[f];
    volume[piece[f]] += six_volumes(origin, mesh.points[a], mesh.points[b], mesh.points[c]);
  }
  std::vector<bool> outer;
  for (const std::uint32_t p : piece) outer.push_back(volume[p] > 0);
  return outer;
}

void add_surface(Text& text, const char* name, const std::vector<BoundaryFace>& faces,
                 const std::vector<bool>& is_member) {
  if (std::find(is_member.begin(), is_member.end(), true) == is_member.end()) return;
  text.add("*SURFACE, NAME={}, TYPE=ELEMENT\n", name);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (is_member[f]) text.add("{}, S{}\n", faces[f].tet + 1, kAbaqusFace[faces[f].opposite]);
  }
}

}  // namespace

void write_abaqus(const TetMesh& mesh, const std::filesystem::path& path) {
  const auto faces = boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()));
  Text text(path);
  text.add("{}", kHeader);
  text.add("** {} nodes, {} elements of type {}.\n", mesh.points.size(), mesh.tets.size(),
           mesh.order() == 2 ? "C3D10" : "C3D4");
  add_nodes(text, mesh);
  add_elements(text, mesh);
  if (!faces.empty()) {
    add_node_set(text, mesh, faces);
    std::vector<bool> outer = is_outer(mesh, faces);
    add_surface(text, "BOUNDARY", faces, std::vector<bool>(faces.size(), true));
    add_surface(text, "OUTER", faces, outer);
    outer.flip();
    add_surface(text, "CAVITIES", faces, outer);
  }
  text.commit();
}

}  // namespace periost
