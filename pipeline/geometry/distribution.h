#pragma once
// Summaries of one number per element.
#include <vector>

#include "pipeline/data/quality_report.h"

namespace periost {

// Smallest, largest, mean and percentiles; percentile q is the order statistic at position q (n - 1),
// linearly interpolated between its neighbours. The mean is summed in the order given. All zero with count 0
// for no values. `values` is taken by value, since it is partially sorted; O(n). Precondition: no NaN.
Distribution distribution_of(std::vector<double> values);

// The value below which a share `q` (0..1) of the weight lies: values are sorted, and the first whose
// cumulated weight reaches q times the total is returned; 0 for no values. O(n log n).
struct WeightedValue {
  double value = 0, weight = 0;
};
double weighted_quantile(std::vector<WeightedValue> values, double q);

}  // namespace periost
