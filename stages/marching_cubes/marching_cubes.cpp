#include "stages/marching_cubes/marching_cubes.h"

#include <algorithm>

#include <fmt/format.h>

#include "pipeline/base/error.h"
#include "pipeline/base/parallel.h"
#include "pipeline/geometry/isosurface_components.h"
#include "stages/marching_cubes/slab.h"

namespace periost {
namespace {

// Where a slab's parts stand in the whole surface.
struct SlabOffset {
  std::size_t points = 0;
  std::size_t triangles = 0;
  std::size_t blocks = 0;
};

std::vector<SlabOffset> offsets_of(const std::vector<SlabSurface>& slabs) {
  std::vector<SlabOffset> offsets(slabs.size() + 1);
  for (std::size_t s = 0; s < slabs.size(); ++s) {
    offsets[s + 1].points = offsets[s].points + slabs[s].own + slabs[s].inner_points.size();
    offsets[s + 1].triangles = offsets[s].triangles + slabs[s].triangles.size();
    offsets[s + 1].blocks = offsets[s].blocks + slabs[s].blocks.size();
  }
  return offsets;
}

// Copies one slab to its place, from its own numbers to those of the whole; see SlabSurface.
void join_slab(const SlabSurface& slab, const SlabOffset& here, const SlabOffset& next, Isosurface& out) {
  const auto count = [](std::size_t n) { return static_cast<Index>(n); };
  const Index shared_end = count(slab.edge_points.size());
  const auto whole = [&](Index v) {
    if (v < slab.own) return count(here.points) + v;
    if (v < shared_end) return count(next.points) + (v - slab.own);
    return count(here.points) + slab.own + (v - shared_end);
  };
  const auto at = [](auto& values, std::size_t n) { return values.begin() + static_cast<std::ptrdiff_t>(n); };
  std::copy_n(slab.edge_points.begin(), slab.own, at(out.surface.points, here.points));
  std::copy(slab.inner_points.begin(), slab.inner_points.end(),
            at(out.surface.points, here.points + slab.own));
  std::transform(slab.triangles.begin(), slab.triangles.end(), at(out.surface.triangles, here.triangles),
                 [&](const Triangle& t) {
                   return Triangle{whole(t[0]), whole(t[1]), whole(t[2])};
                 });
  for (std::size_t b = 0; b < slab.blocks.size(); ++b) {
    CellBlock& block = out.blocks[here.blocks + b];
    block = slab.blocks[b];
    block.first_triangle += count(here.triangles);
    out.block_table[slab.block_entries[b]] = count(here.blocks + b);
  }
}

Isosurface join(const GridFrame& frame, std::vector<SlabSurface>& slabs, const Context& context) {
  const std::vector<SlabOffset> offsets = offsets_of(slabs);
  const SlabOffset& total = offsets.back();
  if (total.triangles >= kNoIndex || total.points >= kNoIndex) {
    throw Error(
        ErrorKind::kLimit, "marching_cubes.too_large",
        fmt::format("the isosurface has {} triangles, more than 32-bit indices can number", total.triangles),
        "crop or resample the image");
  }
  Isosurface out;
  out.frame = frame;
  out.surface.voxel_mm = frame.largest_spacing();
  out.surface.points.resize(total.points);
  out.surface.triangles.resize(total.triangles);
  out.blocks.resize(total.blocks);
  std::size_t table_size = 1;
  for (const std::int32_t dims : frame.dims)
    table_size *= static_cast<std::size_t>(Isosurface::block_count(dims));
  out.block_table.assign(table_size, kNoIndex);
  parallel_for(context, slabs.size(), [&](std::size_t s) {
    join_slab(slabs[s], offsets[s], offsets[s + 1], out);
    slabs[s] = {};
  });
  return out;
}

}  // namespace

Isosurface marching_cubes(const Image* image, const Mask& mask, const MarchingCubesOptions& options,
                          const Context& context) {
  if (image != nullptr && mask.range && !same_grid(image->frame, mask.frame)) {
    throw Error(ErrorKind::kInput, "marching_cubes.grid", "the mask and the image lie on different grids",
                "give both the same crop and resample, or make the mask after them");
  }
  const SampledField field(image, mask, options.open);
  std::vector<SlabSurface> slabs(static_cast<std::size_t>(Isosurface::block_count(mask.frame.dims[2])));
  {
    Progress progress(context, "extracting the isosurface", slabs.size());
    parallel_for(context, slabs.size(), [&](std::size_t s) {
      slabs[s] = extract_slab(field, static_cast<std::int32_t>(s));
      progress.step();
    });
  }
  Isosurface isosurface = join(mask.frame, slabs, context);
  isosurface.is_open = options.open;
  if (isosurface.surface.triangles.empty()) {
    throw Error(ErrorKind::kInput, "marching_cubes.empty",
                "the mask has no surface: it holds no voxel to bound",
                "choose another threshold, or look at the mask");
  }
  if (options.keep.count > 0) {
    const std::uint32_t dropped = keep_largest_surfaces(isosurface, options.keep.count);
    if (dropped > 0)
      context.info("marching_cubes.dropped", fmt::format("dropped {} smaller surfaces", dropped));
  }
  return isosurface;
}

Isosurface marching_cubes(const Image& image, const ThresholdRange& range,
                          const MarchingCubesOptions& options, const Context& context) {
  Mask mask{image.frame, std::vector<std::uint8_t>(image.values.size()), range};
  constexpr std::size_t kBlock = 1 << 18;
  parallel_blocks(context, image.values.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const double value = static_cast<double>(image.values[v]);
      mask.inside[v] = value >= range.lower && value <= range.upper ? 1 : 0;
    }
  });
  return marching_cubes(&image, mask, options, context);
}

}  // namespace periost
