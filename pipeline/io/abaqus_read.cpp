#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

#include "pipeline/base/file.h"
#include "pipeline/geometry/tet_faces.h"
#include "pipeline/io/abaqus_deck.h"
#include "pipeline/io/mesh_builder.h"

namespace periost {
namespace {

std::string_view trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::string capitals(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  }
  return result;
}

// The parts between commas; an empty one behind the last comma is left out.
std::vector<std::string_view> split(std::string_view line) {
  std::vector<std::string_view> parts;
  while (!line.empty()) {
    const std::size_t comma = std::min(line.find(','), line.size());
    parts.push_back(trimmed(line.substr(0, comma)));
    line.remove_prefix(std::min(comma + 1, line.size()));
  }
  if (!parts.empty() && parts.back().empty()) parts.pop_back();
  return parts;
}

// "*ELEMENT, TYPE=C3D4, ELSET=EALL": capitals, and values by name.
struct Keyword {
  std::string name;
  std::map<std::string, std::string> values;

  std::string value(const std::string& key) const {
    const auto found = values.find(key);
    return found == values.end() ? std::string() : found->second;
  }
};

Keyword keyword_of(std::string_view line) {
  Keyword keyword;
  for (const std::string_view part : split(line.substr(1))) {
    const std::size_t equals = part.find('=');
    const std::string key = capitals(trimmed(part.substr(0, equals)));
    if (keyword.name.empty()) {
      keyword.name = key;
    } else {
      keyword.values[key] =
          equals == std::string_view::npos ? "" : capitals(trimmed(part.substr(equals + 1)));
    }
  }
  return keyword;
}

class Reader {
 public:
  explicit Reader(const std::filesystem::path& path) : path_(path), text_(read_text(path)) {}

  AbaqusDeck read() {
    std::string_view rest = text_;
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find('\n'), rest.size());
      const std::string_view line = trimmed(rest.substr(0, end));
      rest.remove_prefix(std::min(end + 1, rest.size()));
      ++line_;
      if (line.empty() || line.substr(0, 2) == "**") continue;
      if (line[0] == '*') {
        begin(keyword_of(line));
      } else {
        data(split(line));
      }
    }
    if (!pending_.empty()) {
      fail("deck.malformed", "the last element is incomplete",
           "copy or export the file again: its end is missing");
    }
    finish();
    return std::move(deck_);
  }

 private:
  [[noreturn]] void fail(const char* code, const std::string& what) const {
    refuse_mesh(code, fmt::format("{}:{}", path_.string(), line_), what);
  }
  [[noreturn]] void fail(const char* code, const std::string& what, const char* hint) const {
    refuse_mesh(code, fmt::format("{}:{}", path_.string(), line_), what, hint);
  }

  void begin(Keyword keyword) {
    if (!pending_.empty()) fail("deck.malformed", "the element before this line is incomplete");
    keyword_ = std::move(keyword);
    if (keyword_.name == "ASSEMBLY") is_assembly_ = true;
    if (keyword_.name == "END ASSEMBLY") is_assembly_ = false;
    if (keyword_.name == "INCLUDE" && deck_.mesh.tets.empty()) included_ = keyword_.value("INPUT");
    if (keyword_.name == "ELEMENT") begin_elements(keyword_.value("TYPE"));
  }

  // Tetrahedra, and of what has no volume nothing; other solids would be missing from the mesh.
  void begin_elements(const std::string& type) {
    if (type.rfind("C3D4", 0) == 0 || type.rfind("DC3D4", 0) == 0) {
      nodes_per_element_ = 4;
    } else if (type.rfind("C3D10", 0) == 0 || type.rfind("DC3D10", 0) == 0) {
      nodes_per_element_ = 10;
    } else if (type.find("C3D") != std::string::npos || type.rfind("SC", 0) == 0) {
      fail("deck.unsupported",
           fmt::format("elements of type {} are not read, only C3D4 and C3D10", printable(type)),
           "only tetrahedra of first and second order are read: split the others, or leave them out");
    } else {
      nodes_per_element_ = 0;
    }
    const bool is_mixed = nodes_per_element_ > 0 && !deck_.mesh.tets.empty() &&
                          (nodes_per_element_ == 10) != (deck_.mesh.order() == 2);
    if (is_mixed) {
      fail("deck.unsupported", "C3D4 and C3D10 in one deck are not read", "export all elements in one order");
    }
  }

  void data(const std::vector<std::string_view>& parts) {
    if (keyword_.name == "INSTANCE") {
      fail("deck.unsupported", "the instance of a part is moved or turned",
           "export the mesh as one part in its place");
    }
    // Reference points and sets of an assembly have numbers of their own.
    if (is_assembly_) return;
    if (keyword_.name == "NODE") {
      node(parts);
    } else if (keyword_.name == "ELEMENT" && nodes_per_element_ == 0) {
      if (!parts.empty()) passed_over_.insert(whole(parts[0]));
    } else if (keyword_.name == "ELEMENT") {
      element(parts);
    } else if (keyword_.name == "NSET") {
      add_to_set(deck_.node_sets, keyword_.value("NSET"), point_, parts);
    } else if (keyword_.name == "ELSET") {
      add_to_set(deck_.element_sets, keyword_.value("ELSET"), tet_, parts);
    } else if (keyword_.name == "SURFACE" && keyword_.value("TYPE") != "NODE") {
      face(parts);
    }
  }

  std::int64_t whole(std::string_view text) const {
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || value <= 0) {
      fail("deck.malformed", fmt::format("'{}' is not a number of a node or element", printable(text)));
    }
    return value;
  }

  double decimal(std::string_view text) const {
    if (!text.empty() && text[0] == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) {
      fail("deck.malformed", fmt::format("'{}' is not a coordinate", printable(text)));
    }
    return value;
  }

  using Numbers = std::unordered_map<std::int64_t, Index>;

  Index find(const Numbers& numbers, std::int64_t number, const char* what) const {
    const auto found = numbers.find(number);
    if (found == numbers.end()) fail("deck.malformed", fmt::format("{} {} is not defined", what, number));
    return found->second;
  }

  void node(const std::vector<std::string_view>& parts) {
    if (parts.size() < 4) fail("deck.malformed", "a node needs a number and three coordinates");
    const auto index = static_cast<Index>(deck_.mesh.points.size());
    if (!point_.emplace(whole(parts[0]), index).second) {
      fail("deck.malformed", fmt::format("node {} is defined twice", whole(parts[0])));
    }
    deck_.mesh.points.push_back({decimal(parts[1]), decimal(parts[2]), decimal(parts[3])});
    if (!keyword_.value("NSET").empty()) deck_.node_sets[keyword_.value("NSET")].push_back(index);
  }

  // An element may go on over several lines.
  void element(const std::vector<std::string_view>& parts) {
    for (const std::string_view part : parts) pending_.push_back(whole(part));
    if (pending_.size() < nodes_per_element_ + 1) return;
    if (pending_.size() > nodes_per_element_ + 1) fail("deck.malformed", "an element has too many nodes");
    const auto index = static_cast<Index>(deck_.mesh.tets.size());
    if (!tet_.emplace(pending_[0], index).second) {
      fail("deck.malformed", fmt::format("element {} is defined twice", pending_[0]));
    }
    Tetrahedron tet;
    for (std::size_t k = 0; k < 4; ++k) tet[k] = find(point_, pending_[k + 1], "node");
    deck_.mesh.tets.push_back(tet);
    if (nodes_per_element_ == 10) {
      MidsideNodes middle;
      for (std::size_t k = 0; k < 6; ++k) middle[k] = find(point_, pending_[k + 5], "node");
      deck_.mesh.midside.push_back(middle);
    }
    if (!keyword_.value("ELSET").empty()) deck_.element_sets[keyword_.value("ELSET")].push_back(index);
    pending_.clear();
  }

  // Adds the node or element of that number to a set, unless it is one that is passed over.
  void add_member(std::vector<Index>& members, const Numbers& numbers, std::int64_t number) const {
    const bool is_passed_over = &numbers == &tet_ && !tet_.contains(number) && passed_over_.contains(number);
    if (!is_passed_over) members.push_back(find(numbers, number, "member"));
  }

  void add_to_set(std::map<std::string, std::vector<Index>>& sets, const std::string& name,
                  const Numbers& numbers, const std::vector<std::string_view>& parts) {
    if (name.empty()) fail("deck.malformed", "a set has no name");
    std::vector<Index> members;
    if (keyword_.values.contains("GENERATE")) {
      if (parts.size() < 2) fail("deck.malformed", "GENERATE needs a first and a last number");
      const std::int64_t step = parts.size() > 2 ? whole(parts[2]) : 1;
      const std::int64_t last = whole(parts[1]);
      for (std::int64_t n = whole(parts[0]); n <= last; n += step) {
        add_member(members, numbers, n);
        if (step > last - n) break;
      }
    } else {
      for (const std::string_view part : parts) {
        const auto other = sets.find(capitals(part));
        if (other == sets.end()) {
          add_member(members, numbers, whole(part));
        } else {
          members.insert(members.end(), other->second.begin(), other->second.end());
        }
      }
    }
    std::vector<Index>& set = sets[name];
    set.insert(set.end(), members.begin(), members.end());
  }

  void face(const std::vector<std::string_view>& parts) {
    const std::string side = parts.size() == 2 ? capitals(parts[1]) : std::string();
    if (side.size() != 2 || side[0] != 'S' || side[1] < '1' || side[1] > '4') {
      fail("deck.malformed", "a face of a surface is an element and S1, S2, S3 or S4");
    }
    std::vector<DeckFace>& faces = deck_.surfaces[keyword_.value("NAME")];
    const auto set = deck_.element_sets.find(capitals(parts[0]));
    if (set == deck_.element_sets.end()) {
      const std::int64_t number = whole(parts[0]);
      if (!tet_.contains(number) && passed_over_.contains(number)) return;
      faces.push_back({find(tet_, number, "element"), side[1] - '0'});
    } else {
      for (const Index tet : set->second) faces.push_back({tet, side[1] - '0'});
    }
  }

  void finish() {
    TetMesh& mesh = deck_.mesh;
    if (mesh.tets.empty() && !included_.empty()) {
      fail("deck.unsupported", "the deck has no elements of its own, it includes another",
           "give the file that it includes");
    }
    if (mesh.tets.empty()) fail("deck.unsupported", "the deck has no C3D4 or C3D10 elements");
    mesh.region.assign(mesh.tets.size(), 1);
    for (const auto& [name, members] : deck_.element_sets) {
      constexpr std::string_view kPrefix = "REGION_";
      std::int32_t number = 0;
      if (name.substr(0, kPrefix.size()) != kPrefix) continue;
      const char* digits = name.data() + kPrefix.size();
      if (std::from_chars(digits, name.data() + name.size(), number).ptr != name.data() + name.size())
        continue;
      for (const Index tet : members) mesh.region[tet] = number;
    }
    for (const BoundaryFace& at : boundary_faces(tet_neighbours(mesh.tets, mesh.points.size()))) {
      mesh.boundary.push_back(face_of(mesh.tets[at.tet], at.opposite));
    }
  }

  std::filesystem::path path_;
  std::string text_;
  int line_ = 0;
  Keyword keyword_;
  std::size_t nodes_per_element_ = 0;  // of the current type; 0: elements without volume, passed over
  bool is_assembly_ = false;
  std::string included_;
  std::vector<std::int64_t> pending_;  // the numbers of an element that goes on in the next line
  Numbers point_, tet_;
  std::unordered_set<std::int64_t> passed_over_;  // elements without volume
  AbaqusDeck deck_;
};

}  // namespace

AbaqusDeck read_abaqus(const std::filesystem::path& path) {
  return Reader(path).read();
}

}  // namespace periost
