#include "stages/tetgen/hints.h"

namespace periost {

TetgenOptions with_hints(TetgenOptions options, const Hints* hints) {
  for (const HintBall& ball : balls_on(hints, "sizes")) {
    options.sizes.around.push_back(
        {ball.centre_mm, Length::mm(ball.radius_mm), Length::mm(ball.size_mm), SizeFrame::kLps});
  }
  return options;
}

}  // namespace periost
