#include "pipeline/data/hints.h"

#include <algorithm>

namespace periost {

Hints addressed_to(const Hints& hints, const std::string& stage) {
  Hints some;
  for (const Hint& hint : hints.hints) {
    if (hint.stage == stage) some.hints.push_back(hint);
  }
  return some;
}

std::vector<HintBall> balls_on(const Hints* hints, const std::string& parameter) {
  std::vector<HintBall> balls;
  if (hints == nullptr) return balls;
  for (const Hint& hint : hints->hints) {
    if (hint.parameter == parameter) balls.insert(balls.end(), hint.balls.begin(), hint.balls.end());
  }
  return balls;
}

double factor_on(const Hints* hints, const std::string& parameter) {
  double factor = 1;
  if (hints == nullptr) return factor;
  for (const Hint& hint : hints->hints) {
    if (hint.parameter == parameter) factor = std::min(factor, hint.factor);
  }
  return factor;
}

}  // namespace periost
