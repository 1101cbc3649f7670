#include "stages/marching_cubes/slab.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "stages/marching_cubes/case_table.h"
#include "stages/marching_cubes/polygon.h"

namespace periost {
namespace {

constexpr std::int32_t kSide = CellBlock::kSide;
constexpr double kEdgeMargin = 0.02;
using Word = std::uint64_t;

// The crossed edges among 64 neighbours along x, and the number of the vertex on the first of them.
struct EdgeWord {
  Word bits = 0;
  Index first = 0;

  Index vertex(std::uint32_t bit) const {
    return first + static_cast<Index>(std::popcount(bits & ((Word{1} << bit) - 1)));
  }
};

// Works through one slab: marks the inside samples as bits, numbers and places the vertices on crossed edges,
// then makes the triangles block by block.
class SlabExtractor {
 public:
  SlabExtractor(const SampledField& field, std::int32_t number)
      : field_(field),
        number_(number),
        z0_(number * kSide),
        slices_(std::min(kSide + 1, field.frame().dims[2] + 2 - z0_)),
        rows_(field.frame().dims[1] + 2),
        words_(static_cast<std::size_t>(field.frame().dims[0] + 2) / 64 + 2),
        flip_(field.frame().is_left_handed()) {
    const std::size_t count = static_cast<std::size_t>(slices_) * static_cast<std::size_t>(rows_) * words_;
    inside_.resize(count);
    for (auto& edges : edges_) edges.resize(count);
  }

  SlabSurface run() {
    mark_inside();
    for (std::int32_t s = 0; s < slices_; ++s) {
      if (s + 1 == slices_) surface_.own = vertex_count();
      for (std::int32_t y = 0; y < rows_; ++y) {
        place_row(0, y, s);
        place_row(1, y, s);
      }
      if (s + 1 < slices_) {
        for (std::int32_t y = 0; y < rows_; ++y) place_row(2, y, s);
      }
    }
    if (is_last()) surface_.own = vertex_count();
    for (std::int32_t y = 0; y + 1 < rows_; y += kSide) make_block_row(y);
    return std::move(surface_);
  }

 private:
  // A slab whose uppermost slice is the image's last owns it.
  bool is_last() const { return z0_ + slices_ == field_.frame().dims[2] + 2; }
  Index vertex_count() const { return static_cast<Index>(surface_.edge_points.size()); }
  std::size_t row(std::int32_t y, std::int32_t s) const {
    return (static_cast<std::size_t>(s) * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(y)) *
           words_;
  }
  bool is_used(std::int32_t sample, std::size_t axis) const {
    return sample >= field_.first() && sample < field_.last(axis);
  }
  // Bits begin .. end - 1 of word w of a row.
  static Word span(std::int32_t begin, std::int32_t end, std::size_t w) {
    const auto below = [w](std::int32_t bit) -> Word {
      const std::int32_t local = bit - static_cast<std::int32_t>(64 * w);
      return local <= 0 ? 0 : local >= 64 ? ~Word{0} : (Word{1} << local) - 1;
    };
    return below(end) & ~below(begin);
  }
  Word inside(std::size_t index) const { return inside_[index]; }
  // The word shifted so that bit x holds sample x + 1.
  Word inside_next(std::size_t index, std::size_t w) const {
    return inside_[index] >> 1 | (w + 1 < words_ ? inside_[index + 1] << 63 : 0);
  }

  void mark_inside() {
    for (std::int32_t s = 0; s < slices_; ++s) {
      for (std::int32_t y = 0; y < rows_; ++y) field_.add_inside_bits(y, z0_ + s, &inside_[row(y, s)]);
    }
  }

  // Crossed edges along `axis` that begin in word w of a row of samples.
  Word crossed(std::size_t axis, std::int32_t y, std::int32_t s, std::size_t w) const {
    const std::size_t here = row(y, s) + w;
    const std::int32_t last = field_.last(0);
    if (axis == 0) return (inside(here) ^ inside_next(here, w)) & span(field_.first(), last - 1, w);
    const std::size_t there = axis == 1 ? row(y + 1, s) + w : row(y, s + 1) + w;
    return (inside(here) ^ inside(there)) & span(field_.first(), last, w);
  }

  // Numbers and places the vertices on the edges along `axis` that begin in a row of samples.
  void place_row(std::size_t axis, std::int32_t y, std::int32_t s) {
    const std::int32_t z = z0_ + s;
    if (!is_used(y, 1) || !is_used(z, 2) || !is_used(axis == 1 ? y + 1 : y, 1) ||
        !is_used(axis == 2 ? z + 1 : z, 2)) {
      return;
    }
    for (std::size_t w = 0; w < words_; ++w) {
      Word bits = crossed(axis, y, s, w);
      EdgeWord& edges = edges_[axis][row(y, s) + w];
      edges = {bits, vertex_count()};
      for (; bits != 0; bits &= bits - 1) {
        place(axis, static_cast<std::int32_t>(64 * w) + std::countr_zero(bits), y, z);
      }
    }
  }

  void place(std::size_t axis, std::int32_t x, std::int32_t y, std::int32_t z) {
    const double g0 = static_cast<double>(field_.value(x, y, z));
    const double g1 = static_cast<double>(
        field_.value(x + (axis == 0 ? 1 : 0), y + (axis == 1 ? 1 : 0), z + (axis == 2 ? 1 : 0)));
    Vec3 index{x - 1.0, y - 1.0, z - 1.0};
    index[axis] += std::clamp(g0 / (g0 - g1), kEdgeMargin, 1 - kEdgeMargin);
    surface_.edge_points.push_back(field_.frame().to_lps(index));
  }

  // Bit x: cell (x, y, s) holds a part of the surface.
  Word active_cells(std::int32_t y, std::int32_t s, std::size_t w) const {
    const std::array<std::size_t, 4> at{row(y, s) + w, row(y + 1, s) + w, row(y, s + 1) + w,
                                        row(y + 1, s + 1) + w};
    const Word any = inside(at[0]) | inside(at[1]) | inside(at[2]) | inside(at[3]);
    const Word all = inside(at[0]) & inside(at[1]) & inside(at[2]) & inside(at[3]);
    const Word any_next =
        inside_next(at[0], w) | inside_next(at[1], w) | inside_next(at[2], w) | inside_next(at[3], w);
    const Word all_next =
        inside_next(at[0], w) & inside_next(at[1], w) & inside_next(at[2], w) & inside_next(at[3], w);
    return (any | any_next) & ~(all & all_next) & span(field_.first(), field_.last(0) - 1, w);
  }

  // The blocks of the cells that begin in rows y0 .. y0 + 7.
  void make_block_row(std::int32_t y0) {
    std::array<Word, kSide * kSide> active;
    for (std::size_t w = 0; w < words_; ++w) {
      Word any = 0;
      for (std::int32_t n = 0; n < kSide * kSide; ++n) {
        const std::int32_t y = y0 + n % kSide;
        const std::int32_t s = n / kSide;
        const bool is_cell = y >= field_.first() && y + 1 < field_.last(1) && z0_ + s >= field_.first() &&
                             s + 1 < slices_ && z0_ + s + 1 < field_.last(2);
        active[static_cast<std::size_t>(n)] = is_cell ? active_cells(y, s, w) : 0;
        any |= active[static_cast<std::size_t>(n)];
      }
      for (std::int32_t byte = 0; any != 0; any >>= 8, ++byte) {
        if ((any & 0xFF) != 0) make_block(static_cast<std::int32_t>(8 * w) + byte, y0, byte, active);
      }
    }
  }

  void make_block(std::int32_t block_x, std::int32_t y0, std::int32_t byte,
                  const std::array<Word, kSide * kSide>& active) {
    const auto& dims = field_.frame().dims;
    CellBlock& block = surface_.blocks.emplace_back();
    block.first_cell = {block_x * kSide - 1, y0 - 1, z0_ - 1};
    block.first_triangle = static_cast<Index>(surface_.triangles.size());
    surface_.block_entries.push_back(
        static_cast<std::uint32_t>(block_x + Isosurface::block_count(dims[0]) *
                                                 (y0 / kSide + Isosurface::block_count(dims[1]) * number_)));
    std::size_t cell = 0;
    for (std::int32_t n = 0; n < kSide * kSide; ++n) {
      const auto bits = static_cast<unsigned>(active[static_cast<std::size_t>(n)] >> 8 * byte & 0xFF);
      for (std::int32_t x = 0; x < kSide; ++x) {
        if ((bits >> x & 1) != 0) make_cell(block_x * kSide + x, y0 + n % kSide, n / kSide);
        block.first[++cell] = static_cast<std::uint16_t>(surface_.triangles.size() - block.first_triangle);
      }
    }
  }

  // Bit c: corner c of the cell is inside.
  int pattern_of(std::int32_t x, std::int32_t y, std::int32_t s) const {
    int pattern = 0;
    for (int n = 0; n < 4; ++n) {
      std::uint16_t pair = 0;  // samples x and x + 1 lie within 16 bits that begin at a byte
      const auto* bytes = reinterpret_cast<const char*>(&inside_[row(y + (n & 1), s + (n >> 1))]);
      std::memcpy(&pair, bytes + x / 8, sizeof pair);
      pattern |= (pair >> (x % 8) & 3) << 2 * n;
    }
    return pattern;
  }

  Index vertex_on(int edge, std::int32_t x, std::int32_t y, std::int32_t s) const {
    const int begin = edge_begin(edge);
    const auto bit = static_cast<std::uint32_t>(x + (begin & 1));
    const std::size_t at = row(y + (begin >> 1 & 1), s + (begin >> 2)) + bit / 64;
    return edges_[static_cast<std::size_t>(edge / 4)][at].vertex(bit % 64);
  }

  // The asymptotic decider: bit n is set when the inside corners of ambiguous face n are joined. Products of
  // two single-precision values are exact in double precision, so both cells of a face decide alike.
  unsigned joined_faces(const CaseTable::Pattern& pattern, std::int32_t x, std::int32_t y,
                        std::int32_t s) const {
    const auto g = [&](int corner) {
      return static_cast<double>(
          field_.value(x + (corner & 1), y + (corner >> 1 & 1), z0_ + s + (corner >> 2)));
    };
    unsigned joined = 0;
    for (unsigned n = 0; n < pattern.ambiguous_count; ++n) {
      const AmbiguousFace& face = pattern.ambiguous[n];
      if (g(face.inside[0]) * g(face.inside[1]) > g(face.outside[0]) * g(face.outside[1])) joined |= 1u << n;
    }
    return joined;
  }

  void make_cell(std::int32_t x, std::int32_t y, std::int32_t s) {
    const CaseTable::Pattern& pattern = table_.pattern(pattern_of(x, y, s));
    const unsigned joined = pattern.ambiguous_count == 0 ? 0 : joined_faces(pattern, x, y, s);
    for (const CellLoop& loop : table_.loops(pattern, joined)) {
      std::array<Index, kCellEdges> vertices;
      std::array<Vec3, kCellEdges> points;
      for (std::size_t n = 0; n < loop.size; ++n) {
        vertices[n] = vertex_on(loop.edges[n], x, y, s);
        points[n] = surface_.edge_points[vertices[n]];
      }
      make_loop(loop, vertices, points);
    }
  }

  void make_loop(const CellLoop& loop, const std::array<Index, kCellEdges>& vertices,
                 const std::array<Vec3, kCellEdges>& points) {
    const LoopTriangles cut = triangulate_loop(loop, points);
    for (std::size_t n = 0; n < static_cast<std::size_t>(cut.count); ++n) {
      const auto& [a, b, c] = cut.triangles[n];
      add_triangle(vertices[a], vertices[b], vertices[c]);
    }
    if (cut.count > 0) return;
    Vec3 sum;
    for (std::size_t n = 0; n < loop.size; ++n) sum += points[n];
    const Index centre = vertex_count() + static_cast<Index>(surface_.inner_points.size());
    surface_.inner_points.push_back(sum / loop.size);
    for (std::size_t n = 0; n < loop.size; ++n)
      add_triangle(vertices[n], vertices[(n + 1) % loop.size], centre);
  }

  void add_triangle(Index a, Index b, Index c) {
    surface_.triangles.push_back(flip_ ? Triangle{a, c, b} : Triangle{a, b, c});
  }

  const SampledField& field_;
  const CaseTable& table_ = CaseTable::instance();
  std::int32_t number_;
  std::int32_t z0_;      // first slice of samples
  std::int32_t slices_;  // slices of samples in the slab, the shared one on top included
  std::int32_t rows_;
  std::size_t words_;  // of a row of samples; the last is zero
  bool flip_;
  std::vector<Word> inside_;
  std::array<std::vector<EdgeWord>, 3> edges_;  // by axis
  SlabSurface surface_;
};

}  // namespace

SlabSurface extract_slab(const SampledField& field, std::int32_t number) {
  return SlabExtractor(field, number).run();
}

}  // namespace periost
