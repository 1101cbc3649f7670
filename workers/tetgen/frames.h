// SPDX-License-Identifier: AGPL-3.0-or-later
#pragma once
// Requests and replies as bytes on a descriptor (see protocol.h) and as text files (see README.md).
#include <string>

#include "workers/tetgen/mesher.h"

namespace periost_tetgen {

// Reads a whole request. False when the bytes end early or are not a request. Arrays grow as bytes arrive, so
// that a lying count cannot make the program allocate more than it was sent.
bool read_request(int descriptor, Request& request);
// False when the other side has gone.
bool write_reply(int descriptor, const Reply& reply);

// Reads the points, triangles and holes of a text file. Returns a sentence on failure, else nothing.
std::string read_text_file(const std::string& path, Request& request);
// Writes points and tetrahedra, under a temporary name first. Returns a sentence on failure, else nothing.
std::string write_text_file(const std::string& path, const Reply& reply);

}  // namespace periost_tetgen
