// SPDX-License-Identifier: Apache-2.0
#include "servo/algorithms/transfer_function.hpp"

#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "base/formatted.hpp"

namespace palpate {
namespace {

[[noreturn]] void refuseRow(const char* table, std::size_t row, const char* reason, const char* remedy) {
  throw Error(Error::Code::kBadInput, table, formatted("row {}: {}", row + 1, reason), remedy);
}

template <class Row, class Finite, class Key>
void checkRows(const char* table, const std::vector<Row>& rows, Finite finite, Key key) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!finite(rows[i])) refuseRow(table, i, "a number is not finite", "give finite numbers");
    if (i > 0 && !(key(rows[i - 1]) < key(rows[i]))) {
      refuseRow(table, i, "its first number is not above that of the row before", "sort the rows, each once");
    }
  }
}

// The row at which the piece that contains x begins, and how far along the piece x is. Beyond the ends the table is
// constant.
struct Piece {
  std::size_t row = 0;
  double part = 0;
};
template <class Row, class Key>
Piece pieceOf(const std::vector<Row>& rows, double x, Key key) noexcept {
  if (!(x > key(rows.front()))) return {0, 0};
  std::size_t i = 1;
  while (i < rows.size() && !(x < key(rows[i]))) ++i;
  if (i == rows.size()) return {i - 1, 0};
  return {i - 1, (x - key(rows[i - 1])) / (key(rows[i]) - key(rows[i - 1]))};
}

double between(double a, double b, double part) noexcept {
  return a + part * (b - a);
}

double densityOf(const DensityRow& row) noexcept {
  return row.density;
}
double gradientOf(const GradientRow& row) noexcept {
  return row.gradient_per_m;
}

}  // namespace

TransferFunction::TransferFunction(TransferTables tables)
    : density_(std::move(tables.density)), gradient_(std::move(tables.gradient)) {
  constexpr const char* kDensity = "haptization density";
  constexpr const char* kGradient = "haptization gradient";
  if (density_.empty()) {
    throw Error(Error::Code::kBadInput, kDensity, "the table has no rows", "give rows of density, force, viscosity");
  }
  checkRows(
      kDensity, density_,
      [](const DensityRow& r) {
        return std::isfinite(r.density) && std::isfinite(r.force_N) && std::isfinite(r.viscosity_Ns_per_m);
      },
      densityOf);
  checkRows(
      kGradient, gradient_,
      [](const GradientRow& r) { return std::isfinite(r.gradient_per_m) && std::isfinite(r.weight); }, gradientOf);
  for (std::size_t i = 0; i < density_.size(); ++i) {
    if (density_[i].viscosity_Ns_per_m < 0) refuseRow(kDensity, i, "its viscosity is negative", "give 0 N s/m or more");
  }
  for (std::size_t i = 0; i < gradient_.size(); ++i) {
    if (gradient_[i].gradient_per_m < 0)
      refuseRow(kGradient, i, "its gradient is negative", "a magnitude is 0 or more");
    if (gradient_[i].weight < 0) refuseRow(kGradient, i, "its weight is negative", "give 0 or more");
  }
  if (gradient_.empty()) gradient_.push_back({0, 1});
}

TransferTables TransferFunction::standard(double isovalue, const DensityScale& scale) {
  const double contrast = scale.contrast > 0 ? scale.contrast : 1;
  return {{{isovalue, 0, 0}, {isovalue + 0.5 * contrast, kStandardForce_N, kStandardViscosity_Ns_per_m}},
          {{0, 0}, {contrast / (20 * scale.voxel_m), 1}}};
}

TransferFunction::Value TransferFunction::at(double density, double gradient_per_m) const noexcept {
  const Piece d = pieceOf(density_, density, densityOf);
  const DensityRow& low = density_[d.row];
  const DensityRow& high = density_[d.part > 0 ? d.row + 1 : d.row];
  const Piece g = pieceOf(gradient_, gradient_per_m, gradientOf);
  const double weight = between(gradient_[g.row].weight, gradient_[g.part > 0 ? g.row + 1 : g.row].weight, g.part);
  return {weight * between(low.force_N, high.force_N, d.part),
          between(low.viscosity_Ns_per_m, high.viscosity_Ns_per_m, d.part)};
}

}  // namespace palpate
