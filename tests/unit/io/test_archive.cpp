#include <gtest/gtest.h>

#include <fstream>

#include "pipeline/base/file.h"
#include "pipeline/io/archive.h"
#include "tests/support/process.h"

namespace periost::test {
namespace {

template <class T>
Artefact artefact_of(T value) {
  return std::make_shared<const T>(std::move(value));
}

GridFrame oblique_frame() {
  GridFrame frame{{3, 2, 2}, {0.5, 0.7, 1.3}, {-11, 7.25, 1e-3}, {}};
  frame.direction.column = {Vec3{0, 1, 0}, Vec3{1, 0, 0}, Vec3{0, 0, 1}};
  return frame;
}

SurfaceMesh a_surface() {
  SurfaceMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, -0.0}, {0, 1.0 / 3, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.point_fields["provenance"] = {1, 2, 3};
  mesh.triangle_fields["angle"] = {0.1f};
  mesh.voxel_mm = 1.3;
  return mesh;
}

Isosurface an_isosurface() {
  Isosurface isosurface{oblique_frame(), a_surface(), {0, kNoIndex, 1}, {}, true};
  for (const std::uint16_t last : {7, 1000}) {
    CellBlock& block = isosurface.blocks.emplace_back();
    block.first_cell = {-1, 7, last};
    block.first_triangle = last;
    block.first.back() = last;
  }
  return isosurface;
}

SimplexMesh a_simplex_mesh() {
  SimplexMesh mesh;
  mesh.position = {{1, 2, 3}};
  mesh.neighbour = {{SimplexVertex{1}, kNoVertex, SimplexVertex{2}}};
  mesh.face = {{SimplexFace{0}, SimplexFace{1}, kNoFace}};
  mesh.first_vertex = {SimplexVertex{0}};
  mesh.valence = {5};
  mesh.dual_position = {{4, 5, 6}};
  mesh.face_fields["cause"] = {2};
  mesh.report.removals = 12;
  mesh.report.rejected_self_intersection = 3;
  return mesh;
}

TetMesh a_tet_mesh() {
  TetMesh mesh;
  mesh.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.tets = {{0, 1, 2, 3}};
  mesh.midside = {{4, 5, 6, 7, 8, 9}};
  mesh.region = {1};
  mesh.boundary = {{0, 2, 1}};
  mesh.boundary_preserved = false;
  return mesh;
}

QualityReport a_report() {
  QualityReport report;
  report.verdict = Verdict::kWarn;
  report.preset = "fe-standard";
  report.surface.emplace();
  report.surface->distance = SurfaceDistance{"voxel", {1, 2, 3, 4}, {5, 6, 7, 8}, 9, 0.3, std::nullopt};
  report.volume.emplace().jacobian_ratio = Distribution{10, 0, 1, 2, 3, 4, 5, 6, 7};
  report.gates.push_back(
      {"surface.closed", "==", 1.0, std::nullopt, 1, Verdict::kPass, {{3, 0.5, {1, 2, 3}, "swap"}}});
  return report;
}

Hints some_hints() {
  Hints hints;
  hints.hints.push_back({"decimate", "refine", 1, {{{1, 2, 3}, 4, 0.5}}, "surface.closed", 0, 1, 2, "why"});
  hints.rounds.push_back({1, Verdict::kFail, {{"decimate.refine", "1 place"}}, "why"});
  return hints;
}

std::vector<Artefact> one_of_each_kind() {
  Image image{oblique_frame(), {}};
  image.values.resize(image.frame.voxel_count(), -3.25f);
  return {
      artefact_of(image),           artefact_of(Mask{oblique_frame(), {1, 0, 1}, ThresholdRange{226, 3000}}),
      artefact_of(an_isosurface()), artefact_of(a_simplex_mesh()),
      artefact_of(a_surface()),     artefact_of(a_tet_mesh()),
      artefact_of(a_report()),      artefact_of(Deck{{"cranium.inp", "surface.stl"}}),
      artefact_of(some_hints())};
}

TEST(Archive, EveryKindComesBackBitForBit) {
  const TemporaryFolder folder;
  const std::vector<Artefact> artefacts = one_of_each_kind();
  ASSERT_EQ(artefacts.size(), static_cast<std::size_t>(kArtefactKinds));
  for (const Artefact& artefact : artefacts) {
    const auto path = folder.path() / "x.artefact";
    const std::string hash = save_artefact(artefact, path);
    EXPECT_EQ(hash, hash_artefact(artefact));
    const auto back = load_artefact(path, kind_of(artefact), hash);
    ASSERT_TRUE(back.has_value()) << name_of(kind_of(artefact));
    EXPECT_EQ(kind_of(*back), kind_of(artefact));
    EXPECT_EQ(hash_artefact(*back), hash);
    EXPECT_EQ(facts_of(*back), facts_of(artefact));
  }
  EXPECT_TRUE(partial_files(folder.path()).empty());
}

TEST(Archive, ReadBackFieldsKeepTheirValues) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "x";
  const std::string hash = save_artefact(artefact_of(a_report()), path);
  const auto back = load_artefact(path, ArtefactKind::kQuality, hash);
  ASSERT_TRUE(back.has_value());
  const QualityReport& report = *std::get<std::shared_ptr<const QualityReport>>(*back);
  EXPECT_EQ(report.verdict, Verdict::kWarn);
  EXPECT_EQ(report.surface->distance->requested, 0.3);
  EXPECT_FALSE(report.surface->distance->over_requested.has_value());
  EXPECT_EQ(report.volume->jacobian_ratio->mean, 7);
  EXPECT_EQ(report.gates.at(0).worst.at(0).origin, "swap");
}

TEST(Archive, HashSeesEveryBit) {
  SurfaceMesh mesh = a_surface();
  const std::string hash = hash_artefact(artefact_of(mesh));
  mesh.points[1].z = 0.0;  // was -0.0
  EXPECT_NE(hash_artefact(artefact_of(mesh)), hash);
}

TEST(Archive, ADamagedFileCountsAsAbsent) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "x";
  for (const Artefact& artefact : one_of_each_kind()) {
    const std::string hash = save_artefact(artefact, path);
    const std::string whole = read_text(path);
    const std::size_t step = std::max<std::size_t>(whole.size() / 60, 1);
    for (std::size_t at = 0; at < whole.size(); at += step) {
      std::string flipped = whole;
      flipped[at] = static_cast<char>(flipped[at] ^ 0x41);
      std::ofstream(path, std::ios::binary) << flipped;
      EXPECT_FALSE(load_artefact(path, kind_of(artefact), hash).has_value()) << "flipped at " << at;
      std::ofstream(path, std::ios::binary) << whole.substr(0, at);
      EXPECT_FALSE(load_artefact(path, kind_of(artefact), hash).has_value()) << "cut at " << at;
    }
  }
  EXPECT_FALSE(load_artefact(folder.path() / "missing", ArtefactKind::kMask, "").has_value());
}

TEST(Archive, AnotherKindOrHashCountsAsAbsent) {
  const TemporaryFolder folder;
  const auto path = folder.path() / "x";
  const std::string hash = save_artefact(artefact_of(a_surface()), path);
  EXPECT_FALSE(load_artefact(path, ArtefactKind::kTetMesh, hash).has_value());
  EXPECT_FALSE(load_artefact(path, ArtefactKind::kSurface, std::string(32, '0')).has_value());
}

}  // namespace
}  // namespace periost::test
