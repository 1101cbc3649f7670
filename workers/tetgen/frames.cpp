// SPDX-License-Identifier: AGPL-3.0-or-later
#include "workers/tetgen/frames.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>

namespace periost_tetgen {
namespace {

constexpr std::size_t kChunk = std::size_t{1} << 22;

bool read_bytes(int descriptor, void* data, std::size_t bytes) {
  auto* target = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t got = ::read(descriptor, target, std::min(bytes, kChunk));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    target += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

bool write_bytes(int descriptor, const void* data, std::size_t bytes) {
  const auto* source = static_cast<const char*>(data);
  while (bytes > 0) {
    const ssize_t put = ::write(descriptor, source, std::min(bytes, kChunk));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) return false;
    source += put;
    bytes -= static_cast<std::size_t>(put);
  }
  return true;
}

// `items` of `each` numbers.
template <class T>
bool read_array(int descriptor, std::uint64_t items, std::uint64_t each, std::vector<T>& values) {
  if (items > 0xFFFFFFFFU) return false;
  std::uint64_t left = each * items;
  while (left > 0) {
    const auto part = static_cast<std::size_t>(std::min<std::uint64_t>(left, kChunk / sizeof(T)));
    const std::size_t old = values.size();
    values.resize(old + part);
    if (!read_bytes(descriptor, values.data() + old, part * sizeof(T))) return false;
    left -= part;
  }
  return true;
}

bool read_sizes(int descriptor, const RequestHeader& header, SizeGrid& grid) {
  std::uint64_t count = 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    grid.origin[axis] = header.size_origin[axis];
    grid.nodes[axis] = header.size_nodes[axis];
    if (grid.nodes[axis] > 0xFFFF) return false;
    count *= grid.nodes[axis];
  }
  grid.spacing = header.size_spacing;
  return read_array(descriptor, count, 1, grid.values);
}

template <class T>
bool read_section(std::istream& file, const char* name, std::vector<T>& values) {
  std::string word;
  std::size_t count = 0;
  if (!(file >> word >> count) || word != name) return false;
  for (std::size_t i = 0; i < 3 * count; ++i) {
    T value{};
    if (!(file >> value)) return false;
    values.push_back(value);
  }
  return true;
}

void write_text(std::FILE* file, const Reply& reply) {
  std::fprintf(file, "points %zu\n", reply.points.size() / 3);
  for (std::size_t i = 0; i < reply.points.size(); i += 3) {
    std::fprintf(file, "%.17g %.17g %.17g\n", reply.points[i], reply.points[i + 1], reply.points[i + 2]);
  }
  std::fprintf(file, "tetrahedra %zu\n", reply.tets.size() / 4);
  for (std::size_t i = 0; i < reply.tets.size(); i += 4) {
    std::fprintf(file, "%u %u %u %u\n", reply.tets[i], reply.tets[i + 1], reply.tets[i + 2],
                 reply.tets[i + 3]);
  }
}

}  // namespace

bool read_request(int descriptor, Request& request) {
  RequestHeader& header = request.header;
  return read_bytes(descriptor, &header, sizeof header) && header.magic == kRequestMagic &&
         read_array(descriptor, header.points, 3, request.points) &&
         read_array(descriptor, header.triangles, 3, request.triangles) &&
         read_array(descriptor, header.holes, 3, request.holes) &&
         read_array(descriptor, header.regions, 3, request.regions) &&
         read_sizes(descriptor, header, request.sizes);
}

bool write_reply(int descriptor, const Reply& reply) {
  ReplyHeader header;
  header.status = static_cast<std::uint32_t>(reply.status);
  header.message_bytes = static_cast<std::uint32_t>(reply.message.size());
  header.points = reply.points.size() / 3;
  header.tets = reply.tets.size() / 4;
  header.regions = reply.regions.size();
  return write_bytes(descriptor, &header, sizeof header) &&
         write_bytes(descriptor, reply.message.data(), reply.message.size()) &&
         write_bytes(descriptor, reply.points.data(), reply.points.size() * sizeof(double)) &&
         write_bytes(descriptor, reply.tets.data(), reply.tets.size() * sizeof(std::uint32_t)) &&
         write_bytes(descriptor, reply.regions.data(), reply.regions.size() * sizeof(std::uint32_t));
}

std::string read_text_file(const std::string& path, Request& request) {
  std::ifstream file(path);
  if (!file) return "cannot read '" + path + "'";
  if (!read_section(file, "points", request.points)) return "'" + path + "': the points are malformed";
  if (!read_section(file, "triangles", request.triangles)) {
    return "'" + path + "': the triangles are malformed";
  }
  file >> std::ws;
  if (!file.eof() && !read_section(file, "holes", request.holes)) {
    return "'" + path + "': the holes are malformed";
  }
  return {};
}

std::string write_text_file(const std::string& path, const Reply& reply) {
  const std::string partial = path + ".partial";
  std::FILE* file = std::fopen(partial.c_str(), "w");
  if (file == nullptr) return "cannot write '" + path + "': " + std::strerror(errno);
  write_text(file, reply);
  const bool is_written = std::ferror(file) == 0;
  if (std::fclose(file) == 0 && is_written && std::rename(partial.c_str(), path.c_str()) == 0) return {};
  std::remove(partial.c_str());
  return "cannot write '" + path + "'";
}

}  // namespace periost_tetgen
