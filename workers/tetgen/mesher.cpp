// SPDX-License-Identifier: AGPL-3.0-or-later
#include "workers/tetgen/mesher.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

// tetgen.h defines terminatetetgen inline, and it frees the mesh before it throws, which the destructor then
// does again. The definition below takes the place of the library's copy, so the one in the header is hidden.
#define TETLIBRARY
#define terminatetetgen terminatetetgen_of_the_header
#include <tetgen.h>
#undef terminatetetgen

[[noreturn]] __attribute__((visibility("default"))) void terminatetetgen(tetgenmesh* mesh, int reason);
void terminatetetgen(tetgenmesh*, int reason) {
  throw reason;
}

namespace periost_tetgen {
namespace {

struct Sentence {
  Status status;
  const char* text;
};
constexpr Sentence kSentences[] = {
    {Status::kDone, "done"},
    {Status::kMemory, "TetGen ran out of memory"},
    {Status::kBug, "TetGen met an internal error"},
    {Status::kSelfIntersection, "TetGen found that the surface intersects itself"},
    {Status::kTinyFeature, "TetGen met a feature smaller than its tolerance"},
    {Status::kNearlyCoplanar, "TetGen met two triangles that nearly coincide"},
    {Status::kInput, "TetGen refused the surface"},
    {Status::kTimeLimit, "TetGen needed more time than it was given"},
    {Status::kBadRequest, "the request is malformed"},
    {Status::kNothing, "TetGen made no tetrahedra: the surface encloses nothing"},
    {Status::kUnknown, "TetGen stopped for an unknown reason"},
};

// TetGen takes five numbers a region: the seed, the attribute of its tetrahedra, and a largest volume.
void fill_regions(tetgenio& in, const std::vector<double>& seeds) {
  in.numberofregions = static_cast<int>(seeds.size() / 3);
  in.regionlist = new REAL[seeds.size() / 3 * 5];
  REAL* next = in.regionlist;
  for (std::size_t i = 0; i < seeds.size(); i += 3) {
    const std::size_t number = i / 3 + 1;
    for (const REAL value : {seeds[i], seeds[i + 1], seeds[i + 2], static_cast<REAL>(number), REAL{-1}}) {
      *next++ = value;
    }
  }
}

void fill(tetgenio& in, const Request& request) {
  in.firstnumber = 0;
  in.numberofpoints = static_cast<int>(request.points.size() / 3);
  in.pointlist = new REAL[request.points.size()];
  std::copy(request.points.begin(), request.points.end(), in.pointlist);
  in.numberoffacets = static_cast<int>(request.triangles.size() / 3);
  in.facetlist = new tetgenio::facet[request.triangles.size() / 3];
  for (int f = 0; f < in.numberoffacets; ++f) {
    tetgenio::facet& facet = in.facetlist[f];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    for (int k = 0; k < 3; ++k) {
      polygon.vertexlist[k] =
          static_cast<int>(request.triangles[3 * static_cast<std::size_t>(f) + static_cast<std::size_t>(k)]);
    }
  }
  if (!request.holes.empty()) {
    in.numberofholes = static_cast<int>(request.holes.size() / 3);
    in.holelist = new REAL[request.holes.size()];
    std::copy(request.holes.begin(), request.holes.end(), in.holelist);
  }
  if (!request.regions.empty()) fill_regions(in, request.regions);
}

// Six times the signed volume, positive in VTK's order.
double volume6(const std::vector<double>& points, const std::uint32_t* t) {
  constexpr std::size_t kThree = 3;
  double edge[3][3];
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t k = 0; k < 3; ++k)
      edge[i][k] = points[kThree * t[i + 1] + k] - points[kThree * t[0] + k];
  }
  return edge[0][0] * (edge[1][1] * edge[2][2] - edge[1][2] * edge[2][1]) +
         edge[0][1] * (edge[1][2] * edge[2][0] - edge[1][0] * edge[2][2]) +
         edge[0][2] * (edge[1][0] * edge[2][1] - edge[1][1] * edge[2][0]);
}

// TetGen turns all its tetrahedra the same way; the sum of the volumes tells which.
void turn_to_positive(Reply& reply) {
  double sum = 0;
  for (std::size_t t = 0; t < reply.tets.size(); t += 4) sum += volume6(reply.points, &reply.tets[t]);
  if (sum >= 0) return;
  for (std::size_t t = 0; t < reply.tets.size(); t += 4) std::swap(reply.tets[t], reply.tets[t + 1]);
}

Reply take(const tetgenio& out, bool has_regions) {
  Reply reply;
  reply.status = out.numberoftetrahedra > 0 ? Status::kDone : Status::kNothing;
  reply.points.assign(out.pointlist, out.pointlist + 3 * static_cast<std::ptrdiff_t>(out.numberofpoints));
  reply.tets.reserve(4 * static_cast<std::size_t>(out.numberoftetrahedra));
  for (int t = 0; t < out.numberoftetrahedra; ++t) {
    const int* corner = out.tetrahedronlist + static_cast<std::ptrdiff_t>(t) * out.numberofcorners;
    for (int k = 0; k < 4; ++k) reply.tets.push_back(static_cast<std::uint32_t>(corner[k]));
  }
  turn_to_positive(reply);
  for (int t = 0; has_regions && t < out.numberoftetrahedra; ++t) {
    const REAL attribute =
        out.tetrahedronattributelist[static_cast<std::ptrdiff_t>(t) * out.numberoftetrahedronattributes];
    // A region without a seed, which no request of ours has, counts as the first.
    reply.regions.push_back(attribute >= 1 ? static_cast<std::uint32_t>(attribute) - 1 : 0);
  }
  return reply;
}

Reply failed(Status status) {
  Reply reply;
  reply.status = status;
  return reply;
}

// TetGen asks by a plain function; the process makes one mesh.
const SizeGrid* asked_sizes = nullptr;

// Whether an edge of a tetrahedron is longer than what is asked at both its ends. (The larger of the two
// counts, so that an edge of a coarse surface that is kept does not call for points without end.)
bool is_too_large(REAL* a, REAL* b, REAL* c, REAL* d, REAL*, REAL) {
  const REAL* corner[4] = {a, b, c, d};
  double size[4];
  for (int i = 0; i < 4; ++i) size[i] = size_at(*asked_sizes, corner[i]);
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      double squared = 0;
      for (int k = 0; k < 3; ++k) squared += (corner[i][k] - corner[j][k]) * (corner[i][k] - corner[j][k]);
      const double limit = std::max(size[i], size[j]);
      if (squared > limit * limit) return true;
    }
  }
  return false;
}

Reply run(const Request& request) {
  // Neither is ever destroyed: after a failure TetGen's own clean-up cannot be trusted, and the process ends.
  auto* in = new tetgenio;
  auto* out = new tetgenio;
  try {
    fill(*in, request);
    if (!request.sizes.is_empty()) {
      asked_sizes = &request.sizes;
      in->tetunsuitable = is_too_large;
    }
    std::string text = switches(request.header);
    tetgenbehavior behaviour;
    if (!behaviour.parse_commandline(text.data())) return failed(Status::kBadRequest);
    tetrahedralize(&behaviour, in, out);
    return take(*out, !request.regions.empty() && out->numberoftetrahedronattributes > 0);
  } catch (int reason) {
    const bool is_known = (reason >= 1 && reason <= 5) || reason == 10;
    return failed(is_known ? static_cast<Status>(reason) : Status::kUnknown);
  } catch (const std::bad_alloc&) {
    return failed(Status::kMemory);
  }
}

}  // namespace

const char* sentence(Status status) {
  for (const Sentence& entry : kSentences) {
    if (entry.status == status) return entry.text;
  }
  return "unknown status";
}

std::string fault_of(const Request& request) {
  constexpr std::size_t kLargest = 0x7FFFFFFF / 16;  // TetGen counts in int
  if (request.points.size() / 3 > kLargest || request.triangles.size() / 3 > kLargest) {
    return "the surface is too large for TetGen";
  }
  for (const double value : request.points) {
    if (!std::isfinite(value)) return "a coordinate is not a finite number";
  }
  for (const double value : request.holes) {
    if (!std::isfinite(value)) return "a hole's seed is not a finite number";
  }
  for (const double value : request.regions) {
    if (!std::isfinite(value)) return "a region's seed is not a finite number";
  }
  for (const float size : request.sizes.values) {
    if (!std::isfinite(size) || size <= 0) return "a size is not a finite number above 0";
  }
  if (!request.sizes.is_empty() && !(request.sizes.spacing > 0)) return "the grid of sizes has no spacing";
  for (const std::uint32_t index : request.triangles) {
    if (index >= request.points.size() / 3) return "a triangle names a point that does not exist";
  }
  return request.triangles.empty() ? "there are no triangles" : std::string();
}

std::string switches(const RequestHeader& header) {
  char text[160];
  std::snprintf(text, sizeof text, "pq%.10g/%.10g", header.max_radius_edge, header.min_dihedral_deg);
  std::string all = text;
  if (header.max_volume > 0) {
    std::snprintf(text, sizeof text, "a%.17g", header.max_volume);
    all += text;
  }
  if ((header.flags & kPreserveSurface) != 0) all += "Y";
  if (header.optimise_deg > 0) {
    std::snprintf(text, sizeof text, "o/%.10g", header.optimise_deg);
    all += text;
  }
  if (header.tolerance > 0) {
    std::snprintf(text, sizeof text, "T%.10g", header.tolerance);
    all += text;
  }
  if (header.regions > 0) all += "A";
  return all + "JQ";
}

Reply mesh(const Request& request) {
  Reply reply;
  reply.message = fault_of(request);
  reply.status = Status::kBadRequest;
  if (!reply.message.empty()) return reply;
  reply = run(request);
  reply.message = sentence(reply.status);
  return reply;
}

}  // namespace periost_tetgen
