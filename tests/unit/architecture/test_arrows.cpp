// Checks every include of the tree against the table of arrows in ARCHITECTURE.md.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
const fs::path kRoot = PERIOST_SOURCE_DIR;

struct Arrows {
  std::set<std::string> folders;
  std::set<std::string> third_parties;
};

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" `");
  const auto end = text.find_last_not_of(" `");
  return begin == std::string::npos ? std::string() : text.substr(begin, end - begin + 1);
}

std::set<std::string> names_in(const std::string& cell) {
  std::set<std::string> names;
  std::stringstream stream(cell);
  for (std::string name; std::getline(stream, name, ',');) {
    if (!trimmed(name).empty()) names.insert(trimmed(name));
  }
  return names;
}

// The table behind the heading "## Arrows", by folder.
std::map<std::string, Arrows> table_of_arrows() {
  std::map<std::string, Arrows> table;
  std::ifstream page(kRoot / "ARCHITECTURE.md");
  bool is_inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("## ", 0) == 0) is_inside = line == "## Arrows";
    if (!is_inside || line.rfind("| `", 0) != 0) continue;
    std::vector<std::string> cells;
    std::stringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');) cells.push_back(cell);
    table[trimmed(cells.at(0))] = {names_in(cells.at(1)), names_in(cells.at(2))};
  }
  return table;
}

// The row of the table that a source file falls under.
std::string row_of(const fs::path& relative) {
  const std::string path = relative.generic_string();
  if (path.rfind("pipeline/", 0) == 0) return path.substr(0, path.find('/', 9));
  if (path.rfind("workers/tetgen", 0) == 0) return "workers/tetgen";
  return relative.filename() == "stage.cpp" ? "stages/*/stage.cpp" : "stages/*/algorithm";
}

// Which third party an angle-bracket include belongs to; empty for the standard library and the system.
std::string third_party_of(const std::string& include) {
  static const std::vector<std::pair<std::string, std::string>> kPrefixes{{"vtkDICOM", "vtk-dicom"},
                                                                          {"vtkNIFTI", "vtk-dicom"},
                                                                          {"vtkScanco", "vtk-dicom"},
                                                                          {"vtk", "VTK"},
                                                                          {"Eigen/", "Eigen"},
                                                                          {"yaml-cpp/", "yaml-cpp"},
                                                                          {"tetgen", "TetGen"},
                                                                          {"oneapi/tbb", "TBB"},
                                                                          {"tbb/", "TBB"},
                                                                          {"fmt/", "fmt"},
                                                                          {"spdlog/", "spdlog"},
                                                                          {"nlohmann/", "nlohmann-json"},
                                                                          {"CLI/", "CLI11"},
                                                                          {"xxhash", "xxhash"},
                                                                          {"zlib", "zlib"},
                                                                          {"CGAL/", "CGAL"},
                                                                          {"boost/", "Boost"}};
  for (const auto& [prefix, name] : kPrefixes) {
    if (include.rfind(prefix, 0) == 0) return name;
  }
  return {};
}

std::string fault_of(const fs::path& relative, const std::string& include, bool is_quoted,
                     const Arrows& allowed) {
  if (!is_quoted) {
    const std::string party = third_party_of(include);
    return party.empty() || allowed.third_parties.contains(party) ? "" : "may not see " + party;
  }
  const std::string own_folder = relative.parent_path().generic_string() + "/";
  if (include.rfind(own_folder, 0) == 0) return {};
  const bool is_wire_format =
      include == "workers/tetgen/protocol.h" || include == "workers/tetgen/size_grid.h";
  if (is_wire_format && own_folder == "stages/tetgen/") return {};
  if (include.rfind("pipeline/", 0) == 0) {
    const std::string folder = include.substr(9, include.find('/', 9) - 9);
    return allowed.folders.contains(folder) ? "" : "may not include pipeline/" + folder;
  }
  return "includes something outside the table";
}

TEST(Architecture, IncludesFollowTheArrows) {
  const auto table = table_of_arrows();
  ASSERT_GE(table.size(), 12u) << "the table of arrows was not found in ARCHITECTURE.md";
  const std::regex pattern(R"(^\s*#\s*include\s*([<"])([^>"]+)[>"])");
  std::size_t files = 0;
  for (const char* top : {"pipeline", "stages", "workers"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const fs::path relative = fs::relative(entry.path(), kRoot);
      if (relative.extension() != ".h" && relative.extension() != ".cpp") continue;
      const auto row = table.find(row_of(relative));
      ASSERT_NE(row, table.end()) << relative << " is in a folder that the table does not name";
      ++files;
      std::ifstream source(entry.path());
      std::smatch match;
      for (std::string line; std::getline(source, line);) {
        if (!std::regex_search(line, match, pattern)) continue;
        EXPECT_EQ(fault_of(relative, match[2], match[1] == "\"", row->second), "")
            << relative << ": " << line;
      }
    }
  }
  EXPECT_GT(files, 10u);
}

TEST(Architecture, ThirdPartiesStayOutOfHeaders) {
  const std::regex pattern(R"(^\s*#\s*include\s*<(vtk|Eigen/|yaml-cpp/|nlohmann/|tetgen|spdlog/|CLI/))");
  for (const char* top : {"pipeline", "stages"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / top)) {
      const bool is_command_header = entry.path().generic_string().find("pipeline/app/") != std::string::npos;
      if (entry.path().extension() != ".h" || is_command_header) continue;
      std::ifstream source(entry.path());
      for (std::string line; std::getline(source, line);) {
        EXPECT_FALSE(std::regex_search(line, pattern)) << fs::relative(entry.path(), kRoot) << ": " << line;
      }
    }
  }
}

TEST(Architecture, ThePipelineNamesNoStage) {
  std::set<std::string> stages;
  for (const auto& entry : fs::directory_iterator(kRoot / "stages")) {
    if (entry.is_directory()) stages.insert(entry.path().filename().string());
  }
  const std::regex literal("\"([a-z_]+)\"");
  // Words that are also names of artefacts or of keys may stand in the framework.
  for (const char* word : {"labels", "loads", "sets", "materials", "crop"}) stages.erase(word);
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "pipeline")) {
    if (entry.path().extension() != ".cpp" && entry.path().extension() != ".h") continue;
    std::ifstream source(entry.path());
    for (std::string line; std::getline(source, line);) {
      const auto comment = line.find("//");
      const std::string code = line.substr(0, comment);
      for (std::sregex_iterator it(code.begin(), code.end(), literal), end; it != end; ++it) {
        EXPECT_FALSE(stages.contains((*it)[1])) << fs::relative(entry.path(), kRoot) << ": " << line;
      }
    }
  }
}

}  // namespace
