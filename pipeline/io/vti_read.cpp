// VTK's XML image data (.vti), read by VTK. Coordinates are taken as LPS; an extent that does not begin at
// zero goes into the origin.
#include <fmt/format.h>
#include <vtkCallbackCommand.h>
#include <vtkCommand.h>
#include <vtkDataArray.h>
#include <vtkExecutive.h>
#include <vtkFloatArray.h>
#include <vtkImageData.h>
#include <vtkInformation.h>
#include <vtkMatrix3x3.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkStreamingDemandDrivenPipeline.h>
#include <vtkXMLImageDataReader.h>

#include "pipeline/io/image_layout.h"
#include "pipeline/io/text_header.h"
#include "pipeline/io/voxels_read.h"

namespace periost {
namespace {

// The largest ratio of VTK's compressors: zlib and lz4 stay below it.
constexpr std::uint64_t kLargestRatio = 1032;

void keep_first_error(vtkObject* /*caller*/, unsigned long /*event*/, void* to, void* text) {
  auto* kept = static_cast<std::string*>(to);
  if (kept->empty() && text != nullptr) *kept = static_cast<const char*>(text);
}

// VTK's messages span lines and name source files; the last line says what is wrong.
std::string last_sentence(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  const std::size_t colon = text.rfind("): ");
  return colon == std::string::npos ? text : text.substr(colon + 3);
}

struct Reader {
  vtkNew<vtkXMLImageDataReader> vtk;
  vtkNew<vtkCallbackCommand> observer;
  std::string error;

  explicit Reader(const std::filesystem::path& path) {
    observer->SetCallback(keep_first_error);
    observer->SetClientData(&error);
    vtk->AddObserver(vtkCommand::ErrorEvent, observer);
    vtk->SetReaderErrorObserver(observer);
    vtk->SetParserErrorObserver(observer);
    vtk->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, observer);
    vtk->SetFileName(path.c_str());
  }
  void refuse_errors(const std::filesystem::path& path, const char* code) const {
    if (error.empty() && vtk->GetErrorCode() == 0) return;
    refuse_file(path, code,
                fmt::format("cannot be read as VTK image data: {}",
                            error.empty() ? "the XML is broken or cut off" : last_sentence(error)));
  }
};

void check_head(const std::filesystem::path& path) {
  const std::string head = read_head(path);
  if (head.find("<VTKFile") == std::string::npos || head.find("ImageData") == std::string::npos) {
    refuse_file(path, "image.header",
                "is not VTK image data: no <VTKFile> element of type ImageData was found");
  }
}

GridFrame frame_of(const std::filesystem::path& path, vtkInformation& information) {
  std::array<int, 6> extent{};
  std::array<double, 3> spacing{1, 1, 1};
  std::array<double, 3> origin{};
  std::array<double, 9> direction{1, 0, 0, 0, 1, 0, 0, 0, 1};
  information.Get(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent.data());
  if (information.Has(vtkDataObject::SPACING()) != 0)
    information.Get(vtkDataObject::SPACING(), spacing.data());
  if (information.Has(vtkDataObject::ORIGIN()) != 0) information.Get(vtkDataObject::ORIGIN(), origin.data());
  if (information.Has(vtkDataObject::DIRECTION()) != 0)
    information.Get(vtkDataObject::DIRECTION(), direction.data());
  std::array<std::int64_t, 3> dims{};
  std::array<Vec3, 3> step;
  Vec3 first{origin[0], origin[1], origin[2]};
  for (std::size_t a = 0; a < 3; ++a) {
    dims[a] = std::int64_t{extent[2 * a + 1]} - extent[2 * a] + 1;
    step[a] = normalized({direction[a], direction[3 + a], direction[6 + a]}) * spacing[a];
    first += step[a] * extent[2 * a];
  }
  return frame_from_steps(path, checked_dims(path, dims), step, first);
}

struct TypeRow {
  int vtk;
  VoxelType type;
};
constexpr std::array<TypeRow, 13> kTypes{{{VTK_SIGNED_CHAR, VoxelType::kInt8},
                                          {VTK_CHAR, VoxelType::kInt8},
                                          {VTK_UNSIGNED_CHAR, VoxelType::kUint8},
                                          {VTK_SHORT, VoxelType::kInt16},
                                          {VTK_UNSIGNED_SHORT, VoxelType::kUint16},
                                          {VTK_INT, VoxelType::kInt32},
                                          {VTK_UNSIGNED_INT, VoxelType::kUint32},
                                          {VTK_LONG, VoxelType::kInt64},
                                          {VTK_LONG_LONG, VoxelType::kInt64},
                                          {VTK_UNSIGNED_LONG, VoxelType::kUint64},
                                          {VTK_UNSIGNED_LONG_LONG, VoxelType::kUint64},
                                          {VTK_FLOAT, VoxelType::kFloat32},
                                          {VTK_DOUBLE, VoxelType::kFloat64}}};

// The type of the point scalars as the header states it; float32 where none are marked as such.
VoxelType type_of(vtkInformation& information) {
  vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
      &information, vtkDataObject::FIELD_ASSOCIATION_POINTS, vtkDataSetAttributes::SCALARS);
  if (scalars == nullptr) return VoxelType::kFloat32;
  for (const TypeRow& row : kTypes) {
    if (row.vtk == scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE())) return row.type;
  }
  return VoxelType::kFloat32;
}

void check_claim(const std::filesystem::path& path, const GridFrame& frame) {
  const std::string head = read_head(path);
  const bool is_compressed =
      head.substr(0, head.find('>', head.find("<VTKFile"))).find("compressor") != std::string::npos;
  const std::uint64_t most = std::filesystem::file_size(path) * (is_compressed ? kLargestRatio : 1);
  if (frame.voxel_count() <= most) return;
  refuse_file(path, "image.truncated",
              fmt::format("is too small: {} x {} x {} voxels cannot be in its {} bytes", frame.dims[0],
                          frame.dims[1], frame.dims[2], std::filesystem::file_size(path)));
}

vtkDataArray& scalars_of(const std::filesystem::path& path, vtkImageData& image) {
  vtkPointData* data = image.GetPointData();
  vtkDataArray* scalars = data->GetScalars();
  if (scalars == nullptr && data->GetNumberOfArrays() == 1) scalars = data->GetArray(0);
  if (scalars == nullptr) {
    refuse_file(path, "image.type",
                fmt::format("has {} point arrays and marks none as its scalars", data->GetNumberOfArrays()),
                "write the grey values as the point scalars");
  }
  if (scalars->GetNumberOfComponents() != 1) {
    refuse_file(
        path, "image.type",
        fmt::format("holds {} components a voxel; grey values are needed", scalars->GetNumberOfComponents()));
  }
  return *scalars;
}

}  // namespace

ImageLayout vti_layout(const std::filesystem::path& path) {
  check_head(path);
  Reader reader(path);
  reader.vtk->UpdateInformation();
  reader.refuse_errors(path, "image.header");
  ImageLayout layout;
  layout.format = "VTK image data";
  layout.frame = frame_of(path, *reader.vtk->GetOutputInformation(0));
  layout.type = type_of(*reader.vtk->GetOutputInformation(0));
  layout.data_file = path;
  check_claim(path, layout.frame);
  return layout;
}

std::vector<float> read_vti_voxels(const ImageLayout& layout, bool replace_non_finite,
                                   const Context& context) {
  const std::filesystem::path& path = layout.data_file;
  Reader reader(path);
  reader.vtk->Update();
  reader.refuse_errors(path, "image.truncated");
  vtkDataArray& scalars = scalars_of(path, *reader.vtk->GetOutput());
  const std::size_t count = layout.frame.voxel_count();
  if (scalars.GetNumberOfTuples() != static_cast<vtkIdType>(count)) {
    refuse_file(path, "image.truncated",
                fmt::format("holds {} of {} voxels", scalars.GetNumberOfTuples(), count));
  }
  vtkNew<vtkFloatArray> floats;
  floats->DeepCopy(&scalars);
  std::vector<float> values(floats->GetPointer(0), floats->GetPointer(0) + count);
  settle_non_finite(layout, replace_non_finite, context, values);
  return values;
}

}  // namespace periost
