#include "pipeline/io/tetgen_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <system_error>

#include "pipeline/base/file.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/text_scanner.h"

namespace periost {
namespace {

// Which of TetGen's six mid-side columns holds VTK's k-th.
constexpr std::array<std::size_t, 6> kColumn{2, 3, 5, 1, 4, 0};

// One of the two files: counts, then numbered lines.
class Table {
 public:
  Table(const std::filesystem::path& path, const char* item)
      : path_(path), item_(item), text_(read_text(path)), scanner_(text_) {
    scanner_.set_comment('#');
  }
  Table(const Table&) = delete;
  Table& operator=(const Table&) = delete;

  std::string place() const { return fmt::format("{}:{}", path_.string(), scanner_.line()); }

  template <class T>
  T number(const char* what) {
    T value{};
    TextScanner before = scanner_;
    if (scanner_.number(value)) return value;
    const std::string_view word = before.word();
    if (word.empty()) {
      refuse_mesh("mesh.truncated", place(), fmt::format("it ends where {} should follow", what),
                  "copy or export the file again: its end is missing");
    }
    refuse_mesh("mesh.malformed", place(), fmt::format("'{}' is not {}", printable(word), what));
  }
  // The same, where the line may have ended before: then `absent`.
  double number_in_line(double absent) {
    const std::string_view word = scanner_.word_in_line();
    double value = absent;
    std::from_chars(word.data(), word.data() + word.size(), value);
    return value;
  }
  // How many lines follow; every line takes at least two bytes.
  std::uint64_t count() {
    const auto value = number<std::uint64_t>("the number of lines");
    if (value > scanner_.bytes_left() / 2) {
      refuse_mesh("mesh.truncated", place(),
                  fmt::format("{} {}s are more than the file can hold", value, item_),
                  "copy or export the file again: its end is missing");
    }
    return value;
  }
  // The number that begins line `i`: these count from 0 or from 1.
  std::uint64_t line_number(std::uint64_t i) {
    const auto value = number<std::uint64_t>("a line's number");
    if (i == 0) first_ = value;
    if (first_ > 1 || value != first_ + i) {
      refuse_mesh("mesh.malformed", place(),
                  fmt::format("{} {} stands where {} should: they count from 0 or 1 without gaps", item_,
                              value, (first_ > 1 ? 0 : first_) + i));
    }
    return value;
  }
  void skip_line() { scanner_.skip_line(); }

 private:
  std::filesystem::path path_;
  const char* item_;
  std::string text_;
  TextScanner scanner_;
  std::uint64_t first_ = 0;
};

void read_nodes(Table& file, MeshBuilder& mesh) {
  const std::uint64_t nodes = file.count();
  if (const auto dimension = file.number<int>("the dimension"); dimension != 3) {
    refuse_mesh("mesh.unsupported", file.place(),
                fmt::format("points of dimension {} are not read", dimension),
                "give a mesh in space, of dimension 3");
  }
  file.skip_line();
  for (std::uint64_t i = 0; i < nodes; ++i) {
    const std::uint64_t number = file.line_number(i);
    Vec3 position;
    for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = file.number<double>("a coordinate");
    mesh.add_node(number, position);
    file.skip_line();
  }
}

std::int32_t region_of(double attribute) {
  return std::abs(attribute) < 2e9 ? static_cast<std::int32_t>(std::lround(attribute)) : 1;
}

void read_tets(Table& file, MeshBuilder& mesh) {
  const std::uint64_t tets = file.count();
  const auto corners = file.number<std::uint64_t>("the number of nodes a tetrahedron");
  if (corners != 4 && corners != 10) {
    refuse_mesh("mesh.unsupported", file.place(), fmt::format("elements of {} nodes are not read", corners),
                "tetrahedra have 4 nodes, or 10 of second order");
  }
  const bool has_region = file.number_in_line(0) > 0;
  file.skip_line();
  std::vector<std::uint64_t> columns(corners), nodes(corners);
  for (std::uint64_t i = 0; i < tets; ++i) {
    file.line_number(i);
    for (std::uint64_t& node : columns) node = file.number<std::uint64_t>("a node's number");
    nodes = columns;
    for (std::size_t k = 0; 4 + k < corners; ++k) nodes[4 + k] = columns[4 + kColumn[k]];
    mesh.add_tet(nodes, has_region ? region_of(file.number_in_line(1)) : 1);
    file.skip_line();
  }
}

// Exchanges the first two corners of every tetrahedron, and the mid-side nodes that go with them.
void turn(TetMesh& mesh) {
  for (Tetrahedron& tet : mesh.tets) std::swap(tet[0], tet[1]);
  for (MidsideNodes& middle : mesh.midside) {
    std::swap(middle[1], middle[2]);
    std::swap(middle[3], middle[4]);
  }
  for (Triangle& triangle : mesh.boundary) std::swap(triangle[1], triangle[2]);
}

double sum_of_volumes(const TetMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c, d] : mesh.tets) {
    sum += six_volumes(mesh.points[a], mesh.points[b], mesh.points[c], mesh.points[d]);
  }
  return sum;
}

std::filesystem::path existing(const std::filesystem::path& path, const char* extension) {
  std::filesystem::path file = path;
  file.replace_extension(extension);
  std::error_code unknown;
  if (std::filesystem::is_regular_file(file, unknown)) return file;
  refuse_mesh("mesh.missing", path.string(),
              fmt::format("there is no '{}' beside it", file.filename().string()),
              "TetGen's meshes are two files, NAME.node and NAME.ele, in one folder");
}

}  // namespace

AnyMesh read_tetgen(const std::filesystem::path& path) {
  Table nodes(existing(path, ".node"), "node");
  Table tets(existing(path, ".ele"), "tetrahedron");
  const Table* open = &nodes;
  MeshBuilder builder([&open] { return open->place(); });
  read_nodes(nodes, builder);
  open = &tets;
  read_tets(tets, builder);
  AnyMesh mesh = builder.finish();
  if (auto* volume = std::get_if<TetMesh>(&mesh); volume != nullptr && sum_of_volumes(*volume) < 0)
    turn(*volume);
  return mesh;
}

}  // namespace periost
