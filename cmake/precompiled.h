// Parsed once per preset instead of once per source: the standard headers that nearly every source sees.
// Sources include what they use all the same; the strict preset builds without this file.
#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <any>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <variant>
#include <vector>
