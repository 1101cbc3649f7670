#include "pipeline/geometry/distribution.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace periost {

Distribution distribution_of(std::vector<double> values) {
  Distribution d;
  d.count = values.size();
  if (values.empty()) return d;
  double sum = 0;
  for (const double value : values) sum += value;
  d.mean = sum / static_cast<double>(values.size());
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  d.min = *low;
  d.max = *high;

  struct Row {
    double share;
    double Distribution::*member;
  };
  constexpr std::array<Row, 5> kRows{{{0.01, &Distribution::p01},
                                      {0.05, &Distribution::p05},
                                      {0.50, &Distribution::p50},
                                      {0.95, &Distribution::p95},
                                      {0.99, &Distribution::p99}}};
  auto begin = values.begin();  // everything before it is in place
  for (const Row& row : kRows) {
    const double position = row.share * static_cast<double>(values.size() - 1);
    const auto below = values.begin() + static_cast<std::ptrdiff_t>(std::floor(position));
    std::nth_element(begin, below, values.end());
    begin = below;
    double value = *below;
    if (below + 1 != values.end()) {
      const double above = *std::min_element(below + 1, values.end());
      value += (position - std::floor(position)) * (above - value);
    }
    d.*row.member = value;
  }
  return d;
}

double weighted_quantile(std::vector<WeightedValue> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end(), [](const WeightedValue& a, const WeightedValue& b) {
    return a.value != b.value ? a.value < b.value : a.weight < b.weight;
  });
  double total = 0;
  for (const WeightedValue& v : values) total += v.weight;
  double sum = 0;
  for (const WeightedValue& v : values) {
    sum += v.weight;
    if (sum >= q * total) return v.value;
  }
  return values.back().value;
}

}  // namespace periost
