#pragma once
// The container of VTK's XML files (.vtp, .vtu): a header that describes arrays, then their bytes, appended
// raw and little-endian. Written by ourselves: no date, no compression, the same bits on every machine, and
// every write checked.
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pipeline/data/surface_mesh.h"

namespace periost {

// One array; `data` points to memory that outlives the call.
struct VtkXmlArray {
  std::string name;
  const char* type = "Float64";  // VTK's name of the number type
  int components = 1;
  const void* data = nullptr;
  std::size_t tuples = 0;
  std::size_t bytes = 0;
};

// One element inside <Piece>: <Points>, <Polys>, <CellData>, ...
struct VtkXmlSection {
  const char* tag = "";
  std::vector<VtkXmlArray> arrays;
};

// A whole file of one piece. `kind` is "PolyData" or "UnstructuredGrid"; `piece_attributes` as they stand in
// the tag (`NumberOfPoints="8" NumberOfPolys="12"`). The file appears whole or not at all.
// Throws Error{kLimit, "file.disk_full" | "file.unwritable"}.
void write_vtk_xml(const std::filesystem::path& path, const char* kind, const std::string& piece_attributes,
                   const std::vector<VtkXmlArray>& field_data, const std::vector<VtkXmlSection>& sections);

// Arrays over plain vectors, which must outlive the call of write_vtk_xml.
VtkXmlArray vtk_array(std::string name, const std::vector<Vec3>& points);
VtkXmlArray vtk_array(std::string name, const std::vector<float>& values);
VtkXmlArray vtk_array(std::string name, const std::vector<double>& values);
VtkXmlArray vtk_array(std::string name, const std::vector<std::int32_t>& values);
VtkXmlArray vtk_array(std::string name, const std::vector<std::int64_t>& values, int components = 1);
VtkXmlArray vtk_array(std::string name, const std::vector<std::uint8_t>& values);
std::vector<VtkXmlArray> vtk_arrays(const Fields& fields);

// `size`, 2 * `size`, ...: the offsets of `count` cells of equal size.
std::vector<std::int64_t> vtk_offsets(std::size_t count, std::int64_t size);

}  // namespace periost
