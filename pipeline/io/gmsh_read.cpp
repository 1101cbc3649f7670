#include "pipeline/io/gmsh_read.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pipeline/io/gmsh_file.h"

namespace periost {
namespace {

// What Gmsh's manual lists under "element type", as far as its own mesher makes them.
struct ElementType {
  std::int64_t number;
  const char* name;
  int dimension;
  std::size_t nodes;
};
constexpr std::array<ElementType, 31> kTypes{{{1, "line", 1, 2},
                                              {2, "triangle", 2, 3},
                                              {3, "quadrangle", 2, 4},
                                              {4, "tetrahedron", 3, 4},
                                              {5, "hexahedron", 3, 8},
                                              {6, "prism", 3, 6},
                                              {7, "pyramid", 3, 5},
                                              {8, "line of second order", 1, 3},
                                              {9, "triangle of second order", 2, 6},
                                              {10, "quadrangle of second order", 2, 9},
                                              {11, "tetrahedron of second order", 3, 10},
                                              {12, "hexahedron of second order", 3, 27},
                                              {13, "prism of second order", 3, 18},
                                              {14, "pyramid of second order", 3, 14},
                                              {15, "point", 0, 1},
                                              {16, "quadrangle of second order", 2, 8},
                                              {17, "hexahedron of second order", 3, 20},
                                              {18, "prism of second order", 3, 15},
                                              {19, "pyramid of second order", 3, 13},
                                              {20, "triangle of third order", 2, 9},
                                              {21, "triangle of third order", 2, 10},
                                              {22, "triangle of fourth order", 2, 12},
                                              {23, "triangle of fourth order", 2, 15},
                                              {24, "triangle of fifth order", 2, 15},
                                              {25, "triangle of fifth order", 2, 21},
                                              {26, "line of third order", 1, 4},
                                              {27, "line of fourth order", 1, 5},
                                              {28, "line of fifth order", 1, 6},
                                              {29, "tetrahedron of third order", 3, 20},
                                              {30, "tetrahedron of fourth order", 3, 35},
                                              {31, "tetrahedron of fifth order", 3, 56}}};

class GmshReader {
 public:
  explicit GmshReader(const std::filesystem::path& path)
      : file_(path), mesh_([this] { return file_.place(); }) {}

  AnyMesh read() {
    if (file_.next_section() != "MeshFormat")
      file_.fail("mesh.malformed", "it does not begin with $MeshFormat");
    const double version = file_.read_format();
    const bool is_2 = version >= 2 && version < 3;
    if (!is_2 && version != 4.1) {
      refuse_mesh("mesh.unsupported", file_.place(),
                  fmt::format("version {} of the format is not read", version),
                  "save it with Gmsh as version 4.1 or 2.2");
    }
    for (std::string section = file_.next_section(); !section.empty(); section = file_.next_section()) {
      if (section == "Nodes") {
        is_2 ? read_nodes_2() : read_nodes_4();
      } else if (section == "Elements") {
        is_2 ? read_elements_2() : read_elements_4();
      } else {
        file_.skip_section(section);
        continue;
      }
      file_.expect_end(section);
    }
    return mesh_.finish();
  }

 private:
  Vec3 position() {
    const double x = file_.decimal(), y = file_.decimal(), z = file_.decimal();
    return {x, y, z};
  }

  void read_nodes_2() {
    for (std::uint64_t left = file_.text_count(); left > 0; --left) {
      const std::uint64_t number = file_.short_number();
      mesh_.add_node(number, position());
    }
  }

  // Blocks of nodes of one entity: first all numbers, then all coordinates.
  void read_nodes_4() {
    std::uint64_t blocks = file_.count();
    for (int skipped = 0; skipped < 3; ++skipped) file_.size();
    for (; blocks > 0; --blocks) {
      const std::int64_t dimension = file_.integer();
      file_.integer();
      const bool is_parametric = file_.integer() != 0;
      std::vector<std::uint64_t> numbers;
      for (std::uint64_t left = file_.count(); left > 0; --left) numbers.push_back(file_.size());
      for (const std::uint64_t number : numbers) {
        mesh_.add_node(number, position());
        for (std::int64_t k = 0; is_parametric && k < std::min<std::int64_t>(dimension, 3); ++k)
          file_.decimal();
      }
    }
  }

  const ElementType& type(std::int64_t number) const {
    const auto found =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const ElementType& t) { return t.number == number; });
    if (found == kTypes.end())
      refuse_mesh("mesh.unsupported", file_.place(),
                  fmt::format("elements of Gmsh's type {} are not read", number), kOnlyTets);
    return *found;
  }

  void read_elements_2() {
    std::uint64_t left = file_.text_count();
    while (left > 0) {
      std::uint64_t number = file_.is_text() ? file_.short_number() : 0;
      const ElementType& element = type(file_.integer());
      const std::uint64_t in_block = file_.is_text() ? 1 : file_.short_number();
      const std::int64_t tags = file_.integer();
      if (in_block == 0 || in_block > left)
        file_.fail("mesh.malformed", "a block of elements has an impossible length");
      for (std::uint64_t i = 0; i < in_block; ++i) {
        if (!file_.is_text()) number = file_.short_number();
        std::int64_t volume = 1;
        for (std::int64_t tag = 0; tag < tags; ++tag) {
          const std::int64_t value = file_.integer();
          if (tag == 1) volume = value;
        }
        nodes_.clear();
        while (nodes_.size() < element.nodes) nodes_.push_back(file_.short_number());
        add(element, number, volume);
      }
      left -= in_block;
    }
  }

  void read_elements_4() {
    std::uint64_t blocks = file_.count();
    for (int skipped = 0; skipped < 3; ++skipped) file_.size();
    for (; blocks > 0; --blocks) {
      file_.integer();
      const std::int64_t volume = file_.integer();
      const ElementType& element = type(file_.integer());
      for (std::uint64_t left = file_.count(); left > 0; --left) {
        const std::uint64_t number = file_.size();
        nodes_.clear();
        while (nodes_.size() < element.nodes) nodes_.push_back(file_.size());
        add(element, number, volume);
      }
    }
  }

  void add(const ElementType& element, std::uint64_t number, std::int64_t volume) {
    if (element.dimension == 3) {
      if (element.nodes != 4 && element.nodes != 10) refuse(element, number);
      if (element.nodes == 10) std::swap(nodes_[8], nodes_[9]);
      mesh_.add_tet(nodes_, static_cast<std::int32_t>(volume));
    } else if (element.number == 2 || element.number == 9) {
      mesh_.add_triangle(nodes_);
    }
  }

  [[noreturn]] void refuse(const ElementType& element, std::uint64_t number) const {
    refuse_mesh("mesh.unsupported", file_.place(), fmt::format("element {} is a {}", number, element.name),
                kOnlyTets);
  }

  static constexpr char kOnlyTets[] =
      "only tetrahedra of first and second order are measured: split the others, or leave them out";

  GmshFile file_;
  MeshBuilder mesh_;
  std::vector<std::uint64_t> nodes_;
};

}  // namespace

AnyMesh read_gmsh(const std::filesystem::path& path) {
  return GmshReader(path).read();
}

}  // namespace periost
