// SPDX-License-Identifier: Apache-2.0
// apps/report/label_placer.hpp: places labels in a picture or a chart, so that they cover neither each other nor what
// is drawn.
//
// Pixels from the top left corner of the panel. Any thread, one at a time. Cost of a label: a look at every point of
// the lines.
#pragma once

#include <string_view>
#include <vector>

namespace palpate {

// No number takes more, as text: in DejaVu Sans, which is a wide font. `size`: of the font [pixel].
[[nodiscard]] double numberWidth(std::string_view number, double size) noexcept;

struct Pixel {
  double x = 0, y = 0;
};

struct LabelBox {
  double left = 0, top = 0, right = 0, bottom = 0;
};

class LabelPlacer {
 public:
  LabelPlacer(double width, double height) : width_(width), height_(height) {}

  void avoid(const LabelBox& box) { boxes_.push_back(box); }  // labels stay clear of it if there is room
  // Adds a mark. The label of another mark is put nearer to its own mark than to this one, if possible.
  void addMark(const Pixel& at) { marks_.push_back(at); }
  void avoidLine(const std::vector<Pixel>& points);  // labels cross it only if they must

  // A box of this size beside `at`, at the distance `gap`, on the right unless another side is better. Later labels
  // avoid it.
  LabelBox place(const Pixel& at, double gap, double width, double height);
  // Whether the label `words` of the mark `own` could be taken for that of another mark.
  [[nodiscard]] bool isAtAnother(const LabelBox& words, const Pixel& own) const;

 private:
  [[nodiscard]] double cost(const LabelBox& words, const Pixel& own) const;
  [[nodiscard]] LabelBox moved(double x, double y, double width, double height) const;
  double width_, height_;
  std::vector<LabelBox> boxes_;
  std::vector<Pixel> marks_;
  std::vector<Pixel> points_;  // of lines, close together
};

}  // namespace palpate
