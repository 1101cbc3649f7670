#include "stages/decimate/hints.h"

#include <set>

namespace periost {

DecimateOptions with_hints(DecimateOptions options, const Hints* hints) {
  constexpr double kWithoutPlaces = 0.8;
  if (hints == nullptr) return options;
  options.distance.value *= factor_on(hints, "distance");
  if (options.method != DecimateMethod::kPaper) {
    for (const HintBall& ball : balls_on(hints, "refine"))
      options.refine.push_back({ball.centre_mm, ball.radius_mm, Length::mm(ball.size_mm)});
    return options;
  }
  std::set<std::uint32_t> rounds;
  for (const Hint& hint : hints->hints) {
    if (hint.parameter == "refine" && rounds.insert(hint.round).second)
      options.distance.value *= kWithoutPlaces;
  }
  return options;
}

}  // namespace periost
