// SPDX-License-Identifier: Apache-2.0
#include "engine/reference/window.hpp"

#include "engine/reference/gradient.hpp"
#include "engine/reference/half.hpp"

namespace palpate::reference {

std::vector<Sample> windowSamples(const DenseField& field, const Vec3i& first, const Vec3i& size,
                                  const GradientOperator& gradient_operator, const SampleFormat& format) {
  const DenseField smoothed = smoothedFor(gradient_operator, field);
  std::vector<Sample> samples;
  samples.reserve(static_cast<std::size_t>(size.x()) * size.y() * size.z());
  for (int k = first.z(); k < first.z() + size.z(); ++k) {
    for (int j = first.y(); j < first.y() + size.y(); ++j) {
      for (int i = first.x(); i < first.x() + size.x(); ++i) {
        const auto gradient = gradientAt(smoothed, gradient_operator, i, j, k);
        samples.push_back(stored({gradient[0], gradient[1], gradient[2], field.at(i, j, k)}, format));
      }
    }
  }
  return samples;
}

}  // namespace palpate::reference
