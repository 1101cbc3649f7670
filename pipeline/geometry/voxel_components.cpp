#include "pipeline/geometry/voxel_components.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/geometry/disjoint_sets.h"

namespace periost {
namespace {

constexpr std::int32_t kSlices = 8;  // slices in one piece of work

class Labeller {
 public:
  Labeller(const std::array<std::int32_t, 3>& dims, const std::vector<std::uint8_t>& bytes, bool of_zeros,
           Connectivity connectivity, const Context& context)
      : bytes_(bytes),
        of_zeros_(of_zeros),
        is_diagonal_(connectivity == Connectivity::kCorners),
        context_(context) {
    out_.dims = dims;
  }

  VoxelComponents run() {
    find_runs();
    DisjointSets sets(out_.runs.size());
    // Each piece unites runs of its own slices only, so pieces touch different parts of the table; what joins
    // two pieces comes after.
    parallel_for(context_, pieces(), [&](std::size_t piece) {
      const auto [begin, end] = slices(piece);
      for (std::int32_t k = begin; k < end; ++k) unite_slice(sets, k, k > begin);
    });
    for (std::int32_t k = kSlices; k < out_.dims[2]; k += kSlices) unite_with_previous_slice(sets, k);
    number_components(sets);
    return std::move(out_);
  }

 private:
  std::size_t pieces() const { return static_cast<std::size_t>((out_.dims[2] + kSlices - 1) / kSlices); }
  std::pair<std::int32_t, std::int32_t> slices(std::size_t piece) const {
    const auto begin = static_cast<std::int32_t>(piece) * kSlices;
    return {begin, std::min(begin + kSlices, out_.dims[2])};
  }
  std::size_t row(std::int32_t j, std::int32_t k) const {
    return static_cast<std::size_t>(j) + static_cast<std::size_t>(out_.dims[1]) * static_cast<std::size_t>(k);
  }
  bool is_wanted(std::uint8_t byte) const { return (byte == 0) == of_zeros_; }

  void append_runs(std::size_t row, std::vector<VoxelRun>& runs) const {
    const std::int32_t count = out_.dims[0];
    const std::uint8_t* first = bytes_.data() + row * static_cast<std::size_t>(count);
    std::int32_t i = 0;
    while (i < count) {
      if (!is_wanted(first[i])) {
        // Outside, zeros come in long stretches: memchr skips them fast.
        const void* next =
            of_zeros_ ? std::memchr(first + i, 0, static_cast<std::size_t>(count - i)) : nullptr;
        if (of_zeros_) {
          if (next == nullptr) return;
          i = static_cast<std::int32_t>(static_cast<const std::uint8_t*>(next) - first);
        } else {
          ++i;
        }
        continue;
      }
      const std::int32_t begin = i;
      while (i < count && is_wanted(first[i])) ++i;
      runs.push_back({begin, i, kNoIndex});
    }
  }

  void find_runs() {
    const std::size_t rows = row(0, out_.dims[2]);
    std::vector<std::vector<VoxelRun>> found(pieces());
    out_.row_first.assign(rows + 1, 0);
    parallel_for(context_, pieces(), [&](std::size_t piece) {
      const auto [begin, end] = slices(piece);
      for (std::size_t r = row(0, begin); r < row(0, end); ++r) {
        append_runs(r, found[piece]);
        out_.row_first[r + 1] = found[piece].size();  // counted within the piece for now
      }
    });
    std::vector<std::size_t> first(pieces() + 1, 0);
    for (std::size_t piece = 0; piece < pieces(); ++piece)
      first[piece + 1] = first[piece] + found[piece].size();
    if (first.back() >= kNoIndex) {
      throw Error(ErrorKind::kLimit, "components.too_many",
                  "the image has too many separate rows of voxels to label", "smooth or crop the image");
    }
    out_.runs.resize(first.back());
    parallel_for(context_, pieces(), [&](std::size_t piece) {
      std::copy(found[piece].begin(), found[piece].end(),
                out_.runs.begin() + static_cast<std::ptrdiff_t>(first[piece]));
      const auto [begin, end] = slices(piece);
      for (std::size_t r = row(0, begin); r < row(0, end); ++r) out_.row_first[r + 1] += first[piece];
    });
  }

  // Unites the runs of two rows that touch.
  void unite_rows(DisjointSets& sets, std::size_t here, std::size_t there) const {
    const std::int32_t reach = is_diagonal_ ? 1 : 0;
    std::size_t a = out_.row_first[here];
    std::size_t b = out_.row_first[there];
    while (a < out_.row_first[here + 1] && b < out_.row_first[there + 1]) {
      const VoxelRun& ra = out_.runs[a];
      const VoxelRun& rb = out_.runs[b];
      if (ra.begin < rb.end + reach && rb.begin < ra.end + reach) {
        sets.unite(static_cast<Index>(a), static_cast<Index>(b));
      }
      ra.end < rb.end ? ++a : ++b;
    }
  }

  void unite_slice(DisjointSets& sets, std::int32_t k, bool with_previous) const {
    for (std::int32_t j = 1; j < out_.dims[1]; ++j) unite_rows(sets, row(j, k), row(j - 1, k));
    if (with_previous) unite_with_previous_slice(sets, k);
  }

  void unite_with_previous_slice(DisjointSets& sets, std::int32_t k) const {
    for (std::int32_t j = 0; j < out_.dims[1]; ++j) {
      unite_rows(sets, row(j, k), row(j, k - 1));
      if (!is_diagonal_) continue;
      if (j > 0) unite_rows(sets, row(j, k), row(j - 1, k - 1));
      if (j + 1 < out_.dims[1]) unite_rows(sets, row(j, k), row(j + 1, k - 1));
    }
  }

  void number_components(DisjointSets& sets) {
    for (std::size_t r = 0; r + 1 < out_.row_first.size(); ++r) {
      const auto j = static_cast<std::int32_t>(r % static_cast<std::size_t>(out_.dims[1]));
      const auto k = static_cast<std::int32_t>(r / static_cast<std::size_t>(out_.dims[1]));
      const bool is_border_row = j == 0 || k == 0 || j + 1 == out_.dims[1] || k + 1 == out_.dims[2];
      for (std::size_t n = out_.row_first[r]; n < out_.row_first[r + 1]; ++n) {
        VoxelRun& run = out_.runs[n];
        const Index root = sets.find(static_cast<Index>(n));
        if (root == n) {
          run.component = static_cast<Index>(out_.components.size());
          out_.components.emplace_back();
        } else {
          run.component = out_.runs[root].component;
        }
        VoxelComponent& component = out_.components[run.component];
        component.voxels += static_cast<std::uint64_t>(run.end - run.begin);
        if (is_border_row || run.begin == 0 || run.end == out_.dims[0]) component.touches_border = true;
      }
    }
  }

  const std::vector<std::uint8_t>& bytes_;
  bool of_zeros_;
  bool is_diagonal_;
  const Context& context_;
  VoxelComponents out_;
};

}  // namespace

VoxelComponents label_components(const std::array<std::int32_t, 3>& dims,
                                 const std::vector<std::uint8_t>& bytes, bool of_zeros,
                                 Connectivity connectivity, const Context& context) {
  return Labeller(dims, bytes, of_zeros, connectivity, context).run();
}

std::vector<Index> components_by_size(const VoxelComponents& labels) {
  std::vector<Index> order(labels.components.size());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) {
    return labels.components[a].voxels > labels.components[b].voxels;
  });
  return order;
}

void set_components(const VoxelComponents& labels, const std::vector<std::uint8_t>& selected,
                    std::uint8_t value, std::vector<std::uint8_t>& bytes, const Context& context) {
  constexpr std::size_t kRows = 1 << 12;
  parallel_blocks(context, labels.row_first.size() - 1, kRows, [&](std::size_t begin, std::size_t end) {
    for (std::size_t r = begin; r < end; ++r) {
      std::uint8_t* row = bytes.data() + r * static_cast<std::size_t>(labels.dims[0]);
      for (std::size_t n = labels.row_first[r]; n < labels.row_first[r + 1]; ++n) {
        const VoxelRun& run = labels.runs[n];
        if (selected[run.component] != 0) std::fill(row + run.begin, row + run.end, value);
      }
    }
  });
}

}  // namespace periost
