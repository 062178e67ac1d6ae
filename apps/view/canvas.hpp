// SPDX-License-Identifier: Apache-2.0
// apps/view/canvas.hpp: a picture to draw on: wraps the few Cairo calls that pictures need, and checks their errors.
//
// Pixels from the top left. One thread per canvas. Private to apps/view: Cairo's headers do not leave it.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <cairo/cairo.h>

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
  // A white picture [pixel]. Throws Error(kOutOfMemory) if Cairo cannot make it.
  Canvas(int width, int height);

  void fillRectangle(double x, double y, double width, double height, const Color& color);
  void strokeRectangle(double x, double y, double width, double height, const Color& color, double line);
  void image(const RenderedImage& image, double x, double y);
  // A polyline with round joints; `dash` [pixel], 0 for solid.
  void polyline(const std::vector<Pixel>& points, const Color& color, double line, double dash = 0);
  void arrow(const Pixel& from, const Pixel& to, const Color& color, double line);
  void disc(const Pixel& centre, double radius, const Color& fill, const Color& rim);
  // `at.y` is the base line. `halo`: a light rim, for text over a picture. Returns the width.
  double text(const Pixel& at, const std::string& words, double size, const Color& color, Align align = Align::kLeft,
              bool bold = false, bool halo = false);
  [[nodiscard]] double textWidth(const std::string& words, double size, bool bold = false);

  // Until popClip(), drawing is clipped to the rectangle, whose corner is the origin.
  void pushClip(double x, double y, double width, double height);
  void popClip();

  // Bytes of the PNG file. Throws Error(kOutOfMemory). `between` is called with every piece of the file, and may throw
  // to cancel.
  [[nodiscard]] std::string png(const std::function<void()>& between = {});

 private:
  struct Close {
    void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
    void operator()(cairo_t* context) const { cairo_destroy(context); }
  };
  void setColor(const Color& color);
  void setFont(double size, bool bold);
  void trace(const std::vector<Pixel>& points);
  std::unique_ptr<cairo_surface_t, Close> surface_;
  std::unique_ptr<cairo_t, Close> context_;
};

}  // namespace palpate
