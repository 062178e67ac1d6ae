// SPDX-License-Identifier: Apache-2.0
// apps/view/canvas.hpp: a picture to draw on. It is Cairo's, in the module "cairo" (base/module.hpp).
//
// Pixels from the top left. One thread per canvas. Private to apps/view.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "apps/report/label_placer.hpp"
#include "base/camera.hpp"

namespace palpate {

struct Color {
  double red = 0, green = 0, blue = 0, alpha = 1;  // 0..1
  [[nodiscard]] Color faded(double share) const { return {red, green, blue, alpha * share}; }
};

enum class Align { kLeft, kCentre, kRight };

class Canvas {
 public:
  virtual ~Canvas() = default;

  virtual void fillRectangle(double x, double y, double width, double height, const Color& color) = 0;
  virtual void strokeRectangle(double x, double y, double width, double height, const Color& color, double line) = 0;
  virtual void image(const RenderedImage& image, double x, double y) = 0;
  // A polyline with round joints; `dash` [pixel], 0 for solid.
  virtual void polyline(const std::vector<Pixel>& points, const Color& color, double line, double dash = 0) = 0;
  virtual void arrow(const Pixel& from, const Pixel& to, const Color& color, double line) = 0;
  virtual void disc(const Pixel& centre, double radius, const Color& fill, const Color& rim) = 0;
  // `at.y` is the base line. `halo`: a light rim, for text over a picture. Returns the width.
  virtual double text(const Pixel& at, const std::string& words, double size, const Color& color,
                      Align align = Align::kLeft, bool bold = false, bool halo = false) = 0;
  [[nodiscard]] virtual double textWidth(const std::string& words, double size, bool bold = false) = 0;

  // Until popClip(), drawing is clipped to the rectangle, whose corner is the origin.
  virtual void pushClip(double x, double y, double width, double height) = 0;
  virtual void popClip() = 0;

  // Bytes of the PNG file. Throws Error(kOutOfMemory). `between` is called with every piece of the file, and may throw
  // to cancel.
  [[nodiscard]] virtual std::string png(const std::function<void()>& between = {}) = 0;
};

struct CairoModule {
  static constexpr const char* kModule = "cairo";
  static constexpr const char* kTable = "palpate_cairo";
  std::unique_ptr<Canvas> (*make)(int width, int height);
};

// A white picture [pixel]. Throws Error(kOutOfMemory) if Cairo cannot make it, and as loadModule() does.
[[nodiscard]] std::unique_ptr<Canvas> makeCanvas(int width, int height);

}  // namespace palpate
