#include "pipeline/io/archive.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <type_traits>
#include <utility>

#include "pipeline/base/file.h"
#include "pipeline/base/hash.h"

namespace periost {
namespace {

constexpr std::array<char, 8> kMagic{'P', 'E', 'R', 'I', 'O', 'A', 'R', 'T'};
constexpr std::uint32_t kVersion = 7;
constexpr std::size_t kHashDigits = 32;
constexpr std::size_t kHeaderBytes = kMagic.size() + 4 + 4 + 8;

struct Damaged {};

// Three walkers over the same members: one counts bytes, one writes and hashes, one reads. `walk` below names
// the members of every type once; a type that gains a member no longer compiles there (the bindings do not
// fit).
struct Counter {
  static constexpr bool kReads = false;
  std::uint64_t bytes = 0;
  void raw(const void*, std::size_t size) { bytes += size; }
};

struct HashWriter {
  static constexpr bool kReads = false;
  Hasher hasher{};
  AtomicFile* file = nullptr;
  void raw(const void* data, std::size_t size) {
    hasher.add(data, size);
    if (file != nullptr) file->write(data, size);
  }
};

struct Reader {
  static constexpr bool kReads = true;
  std::ifstream& file;
  std::uint64_t left;
  void raw(void* data, std::size_t size) {
    if (size > left) throw Damaged{};
    file.read(static_cast<char*>(data), static_cast<std::streamsize>(size));
    if (!file) throw Damaged{};
    left -= size;
  }
  void check(std::uint64_t count, std::size_t item_bytes) const {
    if (count > left / std::max<std::size_t>(item_bytes, 1)) throw Damaged{};
  }
};

template <class T>
struct IsVec : std::false_type {};
template <class T, std::size_t N>
struct IsVec<std::array<T, N>> : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>> {};
template <>
struct IsVec<Vec3> : std::true_type {};
template <>
struct IsVec<Mat3> : std::true_type {};

// Types whose bytes are their value: no padding, no pointer. A bool is not one (its byte must be checked).
template <class T>
constexpr bool kIsFlat =
    ((std::is_arithmetic_v<T> || std::is_enum_v<T>)&&!std::is_same_v<T, bool>) || IsVec<T>::value;

template <class W, class T>
  requires kIsFlat<std::remove_const_t<T>>
void walk(W& w, T& value) {
  w.raw(&value, sizeof value);
}

template <class W, class B>
  requires std::is_same_v<std::remove_const_t<B>, bool>
void walk(W& w, B& value) {
  std::uint8_t byte = value ? 1 : 0;
  w.raw(&byte, 1);
  if constexpr (W::kReads) {
    if (byte > 1) throw Damaged{};
    value = byte == 1;
  }
}

template <class W, class S>
  requires std::is_same_v<std::remove_const_t<S>, std::string>
void walk(W& w, S& text) {
  std::uint64_t size = text.size();
  walk(w, size);
  if constexpr (W::kReads) {
    w.check(size, 1);
    text.resize(size);
  }
  w.raw(text.data(), size);
}

// Members one after the other.
template <class W, class... Ts>
void members(W& w, Ts&... values) {
  (walk(w, values), ...);
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};
template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

template <class T, class U>
concept Same = std::is_same_v<std::remove_const_t<T>, U>;

// Declared ahead, since they hold one another.
template <class W, class V>
  requires IsVector<std::remove_const_t<V>>::value
void walk(W& w, V& values);
template <class W, class O>
  requires IsOptional<std::remove_const_t<O>>::value
void walk(W& w, O& value);

template <class W, Same<Fields> T>
void walk(W& w, T& fields) {
  std::uint64_t count = fields.size();
  walk(w, count);
  if constexpr (W::kReads) {
    w.check(count, sizeof count);
    for (std::uint64_t i = 0; i < count; ++i) {
      std::pair<std::string, std::vector<float>> field;
      members(w, field.first, field.second);
      fields.insert(std::move(field));
    }
  } else {
    for (const auto& [name, values] : fields) members(w, name, values);
  }
}

template <class W, Same<GridFrame> T>
void walk(W& w, T& frame) {
  auto& [dims, spacing, origin, direction] = frame;
  members(w, dims, spacing, origin, direction);
}

template <class W, Same<Image> T>
void walk(W& w, T& image) {
  auto& [frame, values] = image;
  members(w, frame, values);
}

template <class W, Same<ThresholdRange> T>
void walk(W& w, T& range) {
  auto& [lower, upper] = range;
  members(w, lower, upper);
}

template <class W, Same<Mask> T>
void walk(W& w, T& mask) {
  auto& [frame, inside, range] = mask;
  members(w, frame, inside, range);
}

template <class W, Same<SurfaceMesh> T>
void walk(W& w, T& mesh) {
  auto& [points, triangles, point_fields, triangle_fields, voxel_mm, was_read] = mesh;
  members(w, points, triangles, point_fields, triangle_fields, voxel_mm, was_read);
}

// Member by member: the structure has padding bytes.
template <class W, Same<CellBlock> T>
void walk(W& w, T& block) {
  auto& [first_cell, first_triangle, first] = block;
  members(w, first_cell, first_triangle, first);
}

template <class W, Same<Isosurface> T>
void walk(W& w, T& isosurface) {
  auto& [frame, surface, block_table, blocks, is_open] = isosurface;
  members(w, frame, surface, block_table, blocks, is_open);
}

template <class W, Same<DecimationReport> T>
void walk(W& w, T& report) {
  auto& [before, after, removals, insertions, swaps, relocations, pieces, distance, link, topology,
         barycentric, angle, fold, far, reverse, intersection, dropped] = report;
  members(w, before, after, removals, insertions, swaps, relocations, pieces, distance, link, topology,
          barycentric, angle, fold, far, reverse, intersection, dropped);
}

template <class W, Same<SimplexMesh> T>
void walk(W& w, T& mesh) {
  auto& [position, neighbour, face, first_vertex, valence, dual_position, face_fields, voxel_mm, report] =
      mesh;
  members(w, position, neighbour, face, first_vertex, valence, dual_position, face_fields, voxel_mm, report);
}

template <class W, Same<TetMesh> T>
void walk(W& w, T& mesh) {
  auto& [points, tets, midside, region, boundary, point_fields, tet_fields, voxel_mm, preserved] = mesh;
  members(w, points, tets, midside, region, boundary, point_fields, tet_fields, voxel_mm, preserved);
}

template <class W, Same<Distribution> T>
void walk(W& w, T& d) {
  auto& [count, min, p01, p05, p50, p95, p99, max, mean] = d;
  members(w, count, min, p01, p05, p50, p95, p99, max, mean);
}

template <class W, Same<IsosurfaceQuality> T>
void walk(W& w, T& q) {
  auto& [triangles, vertices, components, euler, closed, manifold, voxel_mm, volume_mm3] = q;
  members(w, triangles, vertices, components, euler, closed, manifold, voxel_mm, volume_mm3);
}

template <class W, Same<DistanceSummary> T>
void walk(W& w, T& d) {
  auto& [max, mean, rms, p99] = d;
  members(w, max, mean, rms, p99);
}

template <class W, Same<SurfaceDistance> T>
void walk(W& w, T& d) {
  auto& [unit, there, back, hausdorff, requested, over_requested] = d;
  members(w, unit, there, back, hausdorff, requested, over_requested);
}

template <class W, Same<SurfaceQuality> T>
void walk(W& w, T& q) {
  auto& [triangles, vertices, components, euler, closed, manifold, oriented, intersections, area, volume,
         angle, radius_ratio, below_20, below_30, valence, distance, simplex_angle, normal_deviation,
         volume_change, same_topology] = q;
  members(w, triangles, vertices, components, euler, closed, manifold, oriented, intersections, area, volume,
          angle, radius_ratio, below_20, below_30, valence, distance, simplex_angle, normal_deviation,
          volume_change, same_topology);
}

template <class W, Same<VolumeQuality> T>
void walk(W& w, T& q) {
  auto& [tets, points, order, inverted, volume, min_dihedral, max_dihedral, radius_ratio, scaled_jacobian,
         mean_ratio, aspect_ratio, size_ratio, jacobian_ratio, preserved] = q;
  members(w, tets, points, order, inverted, volume, min_dihedral, max_dihedral, radius_ratio, scaled_jacobian,
          mean_ratio, aspect_ratio, size_ratio, jacobian_ratio, preserved);
}

template <class W, Same<StretchQuality> T>
void walk(W& w, T& q) {
  auto& [stiffness, energy, p95_von_mises, tets, nodes, iterations] = q;
  members(w, stiffness, energy, p95_von_mises, tets, nodes, iterations);
}

template <class W, Same<ReferenceQuality> T>
void walk(W& w, T& q) {
  auto& [stiffness, energy, p95_von_mises, order, axis, mesh, fine] = q;
  members(w, stiffness, energy, p95_von_mises, order, axis, mesh, fine);
}

template <class W, Same<MechanicsQuality> T>
void walk(W& w, T& q) {
  auto& [patch_error, modes, mode_error, condition_ratio, iterations, iterations_ratio, reference] = q;
  members(w, patch_error, modes, mode_error, condition_ratio, iterations, iterations_ratio, reference);
}

template <class W, Same<WorstElement> T>
void walk(W& w, T& worst) {
  auto& [element, value, centre, origin] = worst;
  members(w, element, value, centre, origin);
}

template <class W, Same<GateResult> T>
void walk(W& w, T& gate) {
  auto& [metric, op, limit, warn, value, status, worst] = gate;
  members(w, metric, op, limit, warn, value, status, worst);
}

template <class W, Same<RoundChange> T>
void walk(W& w, T& change) {
  auto& [key, text] = change;
  members(w, key, text);
}

template <class W, Same<RoundNote> T>
void walk(W& w, T& note) {
  auto& [round, verdict, changed, reason] = note;
  members(w, round, verdict, changed, reason);
}

template <class W, Same<QualityReport> T>
void walk(W& w, T& report) {
  auto& [verdict, preset, isosurface, decimation, surface, volume, mechanics, gates, rounds] = report;
  members(w, verdict, preset, isosurface, decimation, surface, volume, mechanics, gates, rounds);
}

template <class W, Same<HintBall> T>
void walk(W& w, T& ball) {
  auto& [centre, radius, size] = ball;
  members(w, centre, radius, size);
}

template <class W, Same<Hint> T>
void walk(W& w, T& hint) {
  auto& [stage, parameter, factor, balls, metric, value, limit, round, reason] = hint;
  members(w, stage, parameter, factor, balls, metric, value, limit, round, reason);
}

template <class W, Same<Hints> T>
void walk(W& w, T& value) {
  auto& [hints, rounds] = value;
  members(w, hints, rounds);
}

template <class W, Same<Deck> T>
void walk(W& w, T& deck) {
  auto& [files] = deck;
  members(w, files);
}

template <class W, class V>
  requires IsVector<std::remove_const_t<V>>::value
void walk(W& w, V& values) {
  using Item = typename std::remove_const_t<V>::value_type;
  std::uint64_t count = values.size();
  walk(w, count);
  if constexpr (W::kReads) {
    w.check(count, kIsFlat<Item> ? sizeof(Item) : 1);
    values.resize(count);
  }
  if constexpr (kIsFlat<Item>) {
    w.raw(values.data(), count * sizeof(Item));
  } else {
    for (auto& value : values) walk(w, value);
  }
}

template <class W, class O>
  requires IsOptional<std::remove_const_t<O>>::value
void walk(W& w, O& value) {
  bool has_value = value.has_value();
  walk(w, has_value);
  if constexpr (W::kReads) {
    if (has_value) value.emplace();
  }
  if (has_value) walk(w, *value);
}

template <class W>
void walk_artefact(W& w, const Artefact& artefact) {
  std::visit([&w](const auto& value) { walk(w, *value); }, artefact);
}

std::uint32_t kind_number(const Artefact& artefact) {
  return static_cast<std::uint32_t>(artefact.index());
}

// Builds the alternative number `kind` from a reader.
template <std::size_t... Indices>
Artefact read_artefact(Reader& reader, std::size_t kind, std::index_sequence<Indices...>) {
  Artefact artefact;
  const auto read = [&]<std::size_t I>(std::integral_constant<std::size_t, I>) {
    using Pointer = std::variant_alternative_t<I, Artefact>;
    auto value = std::make_shared<std::remove_const_t<typename Pointer::element_type>>();
    walk(reader, *value);
    artefact = Pointer(std::move(value));
  };
  ((Indices == kind ? read(std::integral_constant<std::size_t, Indices>{}) : void()), ...);
  return artefact;
}

// Checks the header and the trailer and leaves the file at the payload; returns the bytes of payload.
std::uint64_t open_payload(std::ifstream& file, std::uint64_t file_bytes, std::uint32_t kind,
                           const std::string& hash) {
  if (file_bytes < kHeaderBytes + kHashDigits) throw Damaged{};
  Reader header{file, kHeaderBytes};
  std::array<char, 8> magic{};
  std::uint32_t version = 0, found_kind = 0;
  std::uint64_t payload = 0;
  members(header, magic, version, found_kind, payload);
  if (magic != kMagic || version != kVersion || found_kind != kind) throw Damaged{};
  if (payload != file_bytes - kHeaderBytes - kHashDigits) throw Damaged{};

  Hasher hasher;
  hasher.add(&kind, sizeof kind);
  std::vector<char> buffer(std::size_t{1} << 20);
  Reader body{file, payload};
  while (body.left > 0) {
    const std::size_t part = std::min<std::uint64_t>(buffer.size(), body.left);
    body.raw(buffer.data(), part);
    hasher.add(buffer.data(), part);
  }
  std::string trailer(kHashDigits, '\0');
  Reader{file, kHashDigits}.raw(trailer.data(), kHashDigits);
  if (trailer != hash || hasher.hex() != hash) throw Damaged{};
  file.seekg(static_cast<std::streamoff>(kHeaderBytes));
  return payload;
}

}  // namespace

std::string hash_artefact(const Artefact& artefact) {
  HashWriter writer;
  const std::uint32_t kind = kind_number(artefact);
  walk(writer, kind);
  walk_artefact(writer, artefact);
  return writer.hasher.hex();
}

std::string save_artefact(const Artefact& artefact, const std::filesystem::path& path) {
  Counter counter;
  walk_artefact(counter, artefact);
  AtomicFile file(path);
  const std::uint32_t kind = kind_number(artefact);
  file.write(kMagic.data(), kMagic.size());
  file.write(&kVersion, sizeof kVersion);
  file.write(&kind, sizeof kind);
  file.write(&counter.bytes, sizeof counter.bytes);
  HashWriter writer;
  walk(writer, kind);
  writer.file = &file;
  walk_artefact(writer, artefact);
  std::string hash = writer.hasher.hex();
  file.write(hash);
  file.commit();
  return hash;
}

std::optional<Artefact> load_artefact(const std::filesystem::path& path, ArtefactKind kind,
                                      const std::string& hash) {
  std::error_code missing;
  const std::uint64_t bytes = std::filesystem::file_size(path, missing);
  std::ifstream file(path, std::ios::binary);
  if (missing || !file) return std::nullopt;
  try {
    Reader reader{file, open_payload(file, bytes, static_cast<std::uint32_t>(kind), hash)};
    Artefact artefact =
        read_artefact(reader, static_cast<std::size_t>(kind), std::make_index_sequence<kArtefactKinds>{});
    if (reader.left != 0) return std::nullopt;
    return artefact;
  } catch (const Damaged&) {
    return std::nullopt;
  }
}

}  // namespace periost
