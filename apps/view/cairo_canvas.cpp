// SPDX-License-Identifier: Apache-2.0
// The module "cairo": canvas.hpp on Cairo.
#include <cmath>
#include <cstdint>
#include <cstring>
#include <exception>
#include <numbers>
#include <utility>

#include <cairo/cairo.h>
#include <fmt/format.h>

#include "apps/view/canvas.hpp"
#include "base/error.hpp"
#include "base/outside_text.hpp"

namespace palpate {
namespace {

constexpr const char* kFont = "DejaVu Sans";
constexpr Color kHalo = {1, 1, 1, 0.85};

void check(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw Error(Error::Code::kOutOfMemory, "picture",
              fmt::format("it cannot be drawn ({})", cairo_status_to_string(status)), "ask for a smaller picture");
}

struct PngFile {
  const std::function<void()>& between;
  std::string bytes{};
  std::exception_ptr failure{};
};

// No exception may pass through Cairo.
cairo_status_t append(void* file, const unsigned char* bytes, unsigned int count) {
  auto& png = *static_cast<PngFile*>(file);
  try {
    if (png.between) png.between();
    png.bytes.append(reinterpret_cast<const char*>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
  } catch (...) {
    png.failure = std::current_exception();
    return CAIRO_STATUS_WRITE_ERROR;
  }
}

// Cairo refuses text that is not UTF-8; names of files need not be. Every byte outside a whole character becomes '?',
// as do control characters and the bytes of those beyond the first plane, which fonts seldom have.
std::string validUtf8(const std::string& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size();) {
    const std::size_t bytes = characterBytes(words, i);
    const bool plain = bytes > 0 && bytes < 4 && static_cast<unsigned char>(words[i]) >= 0x20;
    if (plain) out.append(words, i, bytes);
    if (!plain) out += '?';
    i += plain ? bytes : 1;
  }
  return out;
}

// Cairo's RGB24 is a native 32-bit number with red in bits 16..23.
void copyPixels(const RenderedImage& image, cairo_surface_t* surface) {
  unsigned char* rows = cairo_image_surface_get_data(surface);
  const auto stride = static_cast<std::size_t>(cairo_image_surface_get_stride(surface));
  const auto width = static_cast<std::size_t>(image.width);
  for (std::size_t y = 0; y < static_cast<std::size_t>(image.height); ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      const std::uint8_t* from = &image.rgba[4 * (y * width + x)];
      const std::uint32_t pixel = std::uint32_t{from[0]} << 16 | std::uint32_t{from[1]} << 8 | from[2];
      std::memcpy(rows + y * stride + 4 * x, &pixel, sizeof(pixel));
    }
  }
}

struct Close {
  void operator()(cairo_surface_t* surface) const { cairo_surface_destroy(surface); }
  void operator()(cairo_t* context) const { cairo_destroy(context); }
};

class CairoCanvas final : public Canvas {
 public:
  CairoCanvas(int width, int height);
  void fillRectangle(double x, double y, double width, double height, const Color& color) override;
  void strokeRectangle(double x, double y, double width, double height, const Color& color, double line) override;
  void image(const RenderedImage& image, double x, double y) override;
  void polyline(const std::vector<Pixel>& points, const Color& color, double line, double dash) override;
  void arrow(const Pixel& from, const Pixel& to, const Color& color, double line) override;
  void disc(const Pixel& centre, double radius, const Color& fill, const Color& rim) override;
  double text(const Pixel& at, const std::string& words, double size, const Color& color, Align align, bool bold,
              bool halo) override;
  [[nodiscard]] double textWidth(const std::string& words, double size, bool bold) override;
  void pushClip(double x, double y, double width, double height) override;
  void popClip() override;
  [[nodiscard]] std::string png(const std::function<void()>& between) override;

 private:
  void setColor(const Color& color);
  void setFont(double size, bool bold);
  void trace(const std::vector<Pixel>& points);
  std::unique_ptr<cairo_surface_t, Close> surface_;
  std::unique_ptr<cairo_t, Close> context_;
};

CairoCanvas::CairoCanvas(int width, int height)
    : surface_(cairo_image_surface_create(CAIRO_FORMAT_RGB24, width, height)) {
  check(cairo_surface_status(surface_.get()));
  context_.reset(cairo_create(surface_.get()));
  check(cairo_status(context_.get()));
  fillRectangle(0, 0, width, height, {1, 1, 1});
}

void CairoCanvas::setColor(const Color& color) {
  cairo_set_source_rgba(context_.get(), color.red, color.green, color.blue, color.alpha);
}

void CairoCanvas::setFont(double size, bool bold) {
  cairo_select_font_face(context_.get(), kFont, CAIRO_FONT_SLANT_NORMAL,
                         bold ? CAIRO_FONT_WEIGHT_BOLD : CAIRO_FONT_WEIGHT_NORMAL);
  cairo_set_font_size(context_.get(), size);
}

void CairoCanvas::fillRectangle(double x, double y, double width, double height, const Color& color) {
  setColor(color);
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_fill(context_.get());
}

void CairoCanvas::strokeRectangle(double x, double y, double width, double height, const Color& color, double line) {
  setColor(color);
  cairo_set_line_width(context_.get(), line);
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_stroke(context_.get());
}

void CairoCanvas::image(const RenderedImage& image, double x, double y) {
  const std::unique_ptr<cairo_surface_t, Close> picture(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, image.width, image.height));
  check(cairo_surface_status(picture.get()));
  cairo_surface_flush(picture.get());
  copyPixels(image, picture.get());
  cairo_surface_mark_dirty(picture.get());
  cairo_set_source_surface(context_.get(), picture.get(), x, y);
  cairo_paint(context_.get());
}

void CairoCanvas::trace(const std::vector<Pixel>& points) {
  cairo_new_path(context_.get());
  for (const Pixel& p : points) cairo_line_to(context_.get(), p.x, p.y);
}

void CairoCanvas::polyline(const std::vector<Pixel>& points, const Color& color, double line, double dash) {
  if (points.size() < 2) return;
  setColor(color);
  cairo_set_line_width(context_.get(), line);
  cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
  cairo_set_line_cap(context_.get(), dash > 0 ? CAIRO_LINE_CAP_BUTT : CAIRO_LINE_CAP_ROUND);
  const double dashes[] = {dash, 0.8 * dash};
  cairo_set_dash(context_.get(), dashes, dash > 0 ? 2 : 0, 0);
  trace(points);
  cairo_stroke(context_.get());
  cairo_set_dash(context_.get(), nullptr, 0, 0);
}

void CairoCanvas::arrow(const Pixel& from, const Pixel& to, const Color& color, double line) {
  const double dx = to.x - from.x, dy = to.y - from.y, length = std::hypot(dx, dy);
  if (length < 1) return;
  const double head = std::min(4.5 * line, 0.6 * length), ux = dx / length, uy = dy / length;
  const Pixel neck{to.x - head * ux, to.y - head * uy};
  polyline({from, neck}, color, line, 0);
  setColor(color);
  trace({to,
         {neck.x - 0.42 * head * uy, neck.y + 0.42 * head * ux},
         {neck.x + 0.42 * head * uy, neck.y - 0.42 * head * ux}});
  cairo_close_path(context_.get());
  cairo_fill(context_.get());
}

void CairoCanvas::disc(const Pixel& centre, double radius, const Color& fill, const Color& rim) {
  cairo_new_path(context_.get());
  cairo_arc(context_.get(), centre.x, centre.y, radius, 0, 2 * std::numbers::pi);
  setColor(fill);
  cairo_fill_preserve(context_.get());
  setColor(rim);
  cairo_set_line_width(context_.get(), std::max(1.0, 0.25 * radius));
  cairo_stroke(context_.get());
}

double CairoCanvas::textWidth(const std::string& words, double size, bool bold) {
  setFont(size, bold);
  cairo_text_extents_t extents;
  cairo_text_extents(context_.get(), validUtf8(words).c_str(), &extents);
  return extents.x_advance;
}

double CairoCanvas::text(const Pixel& at, const std::string& given, double size, const Color& color, Align align,
                         bool bold, bool halo) {
  const std::string words = validUtf8(given);
  const double width = textWidth(words, size, bold);
  const double x = at.x - (align == Align::kLeft ? 0 : align == Align::kCentre ? width / 2 : width);
  if (halo) {
    cairo_move_to(context_.get(), x, at.y);
    cairo_text_path(context_.get(), words.c_str());
    setColor(kHalo);
    cairo_set_line_width(context_.get(), size / 3.5);
    cairo_set_line_join(context_.get(), CAIRO_LINE_JOIN_ROUND);
    cairo_stroke(context_.get());
  }
  cairo_move_to(context_.get(), x, at.y);
  setColor(color);
  cairo_show_text(context_.get(), words.c_str());
  return width;
}

void CairoCanvas::pushClip(double x, double y, double width, double height) {
  cairo_save(context_.get());
  cairo_rectangle(context_.get(), x, y, width, height);
  cairo_clip(context_.get());
  cairo_translate(context_.get(), x, y);
}

void CairoCanvas::popClip() {
  cairo_restore(context_.get());
}

std::string CairoCanvas::png(const std::function<void()>& between) {
  PngFile file{between};
  check(cairo_status(context_.get()));
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface_.get(), append, &file);
  if (file.failure) std::rethrow_exception(file.failure);
  check(status);
  return std::move(file.bytes);
}

std::unique_ptr<Canvas> make(int width, int height) {
  return std::make_unique<CairoCanvas>(width, height);
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::CairoModule palpate_cairo = {palpate::make};
