// SPDX-License-Identifier: Apache-2.0
// The filter kernels against ITK, which knows nothing of them: exact where both pick values, else within what the two
// definitions differ by, derived beside each test. Whole volumes: ITK's zero-flux border is border=nearest.
#include <algorithm>
#include <cmath>

#include <itkBilateralImageFilter.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkFlatStructuringElement.h>
#include <itkGaussianOperator.h>
#include <itkGradientAnisotropicDiffusionImageFilter.h>
#include <itkGradientImageFilter.h>
#include <itkGrayscaleDilateImageFilter.h>
#include <itkGrayscaleErodeImageFilter.h>
#include <itkGrayscaleMorphologicalClosingImageFilter.h>
#include <itkGrayscaleMorphologicalOpeningImageFilter.h>
#include <itkImageRegionIterator.h>
#include <itkMedianImageFilter.h>
#include <itkSignedMaurerDistanceMapImageFilter.h>

#include "engine/reference/gradient.hpp"
#include "filtered_fields.hpp"

namespace palpate {
namespace itk_filter_test {

using reference::DenseField;
using Image = itk::Image<float, 3>;

const double kRounding = std::ldexp(1, -24);

// A ball with noise: steps, flat parts, and no two voxels alike. Densities from -3.5 to 3.5.
Volume noisyBall(const Vec3i& size, const Vec3& spacing_m) {
  std::mt19937 random(7);
  const Volume ball = ballField(size, 6.0);
  std::vector<float> values = ball.toDense();
  for (float& value : values) value += static_cast<float>(random() % 4096) / 4096.0F - 0.5F;
  Lattice lattice;
  lattice.spacing_m = spacing_m;
  return Volume::fromDense(size, lattice, values, {});
}
constexpr double kContrast = 7;
const Vec3i kSize(24, 21, 19);

// Spacing in millimetres.
Image::Pointer imageOf(const DenseField& field) {
  const Image::Pointer image = Image::New();
  Image::SizeType size;
  Image::SpacingType spacing;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<itk::SizeValueType>(field.size[static_cast<int>(axis)]);
    spacing[axis] = field.lattice.spacing_m[static_cast<int>(axis)] * 1e3;
  }
  image->SetRegions(size);
  image->SetSpacing(spacing);
  image->Allocate();
  std::copy(field.values.begin(), field.values.end(), image->GetBufferPointer());
  return image;
}

template <typename Filter>
DenseField resultOf(Filter& filter, const DenseField& field) {
  filter.SetInput(imageOf(field));
  filter.Update();
  DenseField result = field;
  const float* values = filter.GetOutput()->GetBufferPointer();
  std::copy_n(values, result.values.size(), result.values.begin());
  return result;
}

DenseField ours(const Volume& volume, const std::string& chain, std::optional<float> isovalue = std::nullopt) {
  return filteredOnGpu(volume, lowerFilters(filterChain(chain), volume.lattice().spacing_m, isovalue));
}

double largestDifference(const DenseField& a, const DenseField& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.values.size(); ++i)
    largest = std::max(largest, std::abs(static_cast<double>(a.values[i]) - b.values[i]));
  return largest;
}

// Both pick one of the values that are there.
TEST(Itk, MediansAreEqual) {
  const Volume volume = noisyBall(kSize, Vec3::Constant(1e-3));
  for (const unsigned radius : {1U, 2U}) {
    const auto filter = itk::MedianImageFilter<Image, Image>::New();
    Image::SizeType reach;
    reach.Fill(radius);
    filter->SetRadius(reach);
    const DenseField itk_result = resultOf(*filter, reference::denseField(volume));
    EXPECT_EQ(differing(ours(volume, "median:" + std::to_string(radius)), itk_result), 0U) << radius;
    EXPECT_GT(differing(itk_result, reference::denseField(volume)), itk_result.values.size() / 2);
  }
}

// A box, and a ball of radius 2: the offsets of at most 2 voxels, as a mask.
class ItkMorphology : public testing::Test {
 protected:
  using Element = itk::FlatStructuringElement<3>;

  static Element box(unsigned radius) {
    Element::RadiusType reach;
    reach.Fill(radius);
    return Element::Box(reach);
  }
  static Element ball() {
    const auto mask = itk::Image<bool, 3>::New();
    itk::Image<bool, 3>::SizeType size;
    size.Fill(5);
    mask->SetRegions(size);
    mask->Allocate();
    for (itk::ImageRegionIterator<itk::Image<bool, 3>> at(mask, mask->GetBufferedRegion()); !at.IsAtEnd(); ++at) {
      const auto index = at.GetIndex();
      at.Set((Vec3i(static_cast<int>(index[0]), static_cast<int>(index[1]), static_cast<int>(index[2])) -
              Vec3i::Constant(2))
                 .squaredNorm() <= 4);
    }
    return Element::FromImage(mask);
  }
  // `settings`: of the filter, beside its shape.
  template <typename Filter>
  static void expectEqual(
      const std::string& name, void (*settings)(Filter&) = [](Filter&) {}) {
    const Volume volume = noisyBall(kSize, Vec3::Constant(1e-3));
    for (const bool is_ball : {false, true}) {
      const auto filter = Filter::New();
      filter->SetKernel(is_ball ? ball() : box(2));
      settings(*filter);
      const DenseField itk_result = resultOf(*filter, reference::denseField(volume));
      const std::string chain = name + (is_ball ? ":2:shape=ball" : ":2");
      EXPECT_EQ(differing(ours(volume, chain), itk_result), 0U) << chain;
      EXPECT_GT(differing(itk_result, reference::denseField(volume)), itk_result.values.size() / 4) << chain;
    }
  }
};

TEST_F(ItkMorphology, DilationsAreEqual) {
  expectEqual<itk::GrayscaleDilateImageFilter<Image, Image, Element>>("dilate");
}
TEST_F(ItkMorphology, ErosionsAreEqual) {
  expectEqual<itk::GrayscaleErodeImageFilter<Image, Image, Element>>("erode");
}
// Without ITK's "safe border", which extends the first of the two results beyond the volume.
TEST_F(ItkMorphology, OpeningsAreEqual) {
  using Opening = itk::GrayscaleMorphologicalOpeningImageFilter<Image, Image, Element>;
  expectEqual<Opening>("open", [](Opening& filter) { filter.SetSafeBorder(false); });
}
TEST_F(ItkMorphology, ClosingsAreEqual) {
  using Closing = itk::GrayscaleMorphologicalClosingImageFilter<Image, Image, Element>;
  expectEqual<Closing>("close", [](Closing& filter) { filter.SetSafeBorder(false); });
}

// Taps of a Gaussian along one axis as ITK makes them: not samples, but e^-t I_n(t), t the variance in voxels
// (Lindeberg). Two means with weights of sum one differ by half the sum of the weights' differences times the
// densities' range at most; along three axes by three such. Rounding: ITK and ours, some 33 products and sums an axis.
TEST(Itk, GaussiansDifferByTheirKernels) {
  const Vec3 spacing_m(0.8e-3, 1e-3, 1.25e-3);
  const Volume volume = noisyBall(kSize, spacing_m);
  const auto steps = lowerFilters(filterChain("gaussian:2.5mm:truncate=5"), spacing_m);
  ASSERT_EQ(steps.size(), 3U);
  double bound = 0;
  for (const FilterStep& step : steps) {
    itk::GaussianOperator<double, 3> kernel;
    kernel.SetDirection(0);
    kernel.SetVariance(std::pow(2.5e-3 / spacing_m[step.axis], 2));
    kernel.SetMaximumError(1e-7);
    kernel.SetMaximumKernelWidth(64);
    kernel.CreateDirectional();
    const int itk_reach = static_cast<int>(kernel.Size() / 2);
    const int reach = step.reach[step.axis];
    double apart = 0;
    for (int tap = -std::max(reach, itk_reach); tap <= std::max(reach, itk_reach); ++tap) {
      const double bessel = std::abs(tap) <= itk_reach ? kernel[static_cast<unsigned>(tap + itk_reach)] : 0;
      const double sampled = std::abs(tap) <= reach ? step.taps[static_cast<std::size_t>(std::abs(tap))] : 0;
      apart += std::abs(bessel - sampled);
    }
    EXPECT_LT(apart, 0.05);  // else the bound would say nothing
    bound += 0.5 * apart * kContrast;
  }
  bound += 3 * 4 * 33 * kRounding * kContrast;
  const auto filter = itk::DiscreteGaussianImageFilter<Image, Image>::New();
  filter->SetVariance(2.5 * 2.5);
  filter->SetUseImageSpacing(true);
  filter->SetMaximumError(1e-7);
  filter->SetMaximumKernelWidth(64);
  const DenseField itk_result = resultOf(*filter, reference::denseField(volume));
  const double difference = largestDifference(filteredOnGpu(volume, steps), itk_result);
  EXPECT_LE(difference, bound);
  RecordProperty("largest_difference_of_contrast", std::to_string(difference / kContrast));
  RecordProperty("bound_of_contrast", std::to_string(bound / kContrast));
  EXPECT_GT(largestDifference(itk_result, reference::denseField(volume)), 2 * bound);
}

// The same formula on the same window. ITK looks weights of density up in a table of N places over four ranges, rounded
// down: off by the slope exp(-1/2) / range times 4 ranges / N = 2.43 / N. With a range of half the contrast every
// weight is at least exp(-2) of its tap, so the mean of values within the contrast moves by 2.43 / N * e^2 = 18 / N of
// it. Rounding: ours adds 125 voxels twice, each of a weight with 3.2 + 7 s^2 + 3 < 21 roundings (s^2 <= 2).
TEST(Itk, BilateralsAreEqualToTheTable) {
  constexpr unsigned kPlaces = 1U << 20U;
  const Volume volume = noisyBall(kSize, Vec3::Constant(1e-3));
  const auto filter = itk::BilateralImageFilter<Image, Image>::New();
  filter->SetDomainSigma(1.0);
  filter->SetRangeSigma(kContrast / 2);
  filter->SetAutomaticKernelSize(false);
  filter->SetRadius(2);
  filter->SetNumberOfRangeGaussianSamples(kPlaces);
  const DenseField itk_result = resultOf(*filter, reference::denseField(volume));
  const double bound = (18.0 / kPlaces + (2 * 125 + 2 * 21 + 8) * kRounding) * kContrast;
  const double difference = largestDifference(ours(volume, "bilateral:1:range=3.5"), itk_result);
  EXPECT_LE(difference, bound);
  RecordProperty("largest_difference_of_contrast", std::to_string(difference / kContrast * 1e6) + "e-6");
  EXPECT_GT(largestDifference(itk_result, reference::denseField(volume)), 1000 * bound);
}

// ITK's conductance is that of the whole gradient's length, ours of the slope across each face; along a field that
// varies along one axis only they are the same: exp(-slope^2 / (2 k^2 mean^2)), so kappa = sqrt(2) k mean. On voxels of
// 1 mm, since ITK divides by the spacing once where the equation has it twice. Rounding, ours: a flow by (7 s^2 + 5.2)
// u of itself with s^2 exp(-s^2) <= 1/e, twice, and three sums of values up to the contrast, a step; ITK's likewise.
TEST(Itk, DiffusionsAlongOneAxisAreEqual) {
  for (int axis = 0; axis < 3; ++axis) {
    std::mt19937 random(3);
    std::vector<float> line;
    for (int c = 0; c < 30; ++c) line.push_back(static_cast<float>(random() % 4096) / 2048.0F + (c < 13 ? 0.0F : 5.0F));
    std::vector<float> values;
    const Vec3i size = Vec3i::Constant(12) + 14 * Vec3i::Unit(axis);
    for (int n = 0; n < size.prod(); ++n) {
      const Vec3i voxel(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y());
      values.push_back(line[static_cast<std::size_t>(voxel[axis])]);
    }
    Lattice lattice;
    lattice.spacing_m = Vec3::Constant(1e-3);
    const Volume volume = Volume::fromDense(size, lattice, values, {});
    const auto filter = itk::GradientAnisotropicDiffusionImageFilter<Image, Image>::New();
    constexpr int kSteps = 5;
    filter->SetNumberOfIterations(kSteps);
    filter->SetTimeStep(0.0625);
    filter->SetConductanceParameter(1.0);
    filter->SetFixedAverageGradientMagnitude(1.0);
    filter->SetUseImageSpacing(false);
    const DenseField itk_result = resultOf(*filter, reference::denseField(volume));
    const double bound = kSteps * (2 * (2 * (7 * 0.37 + 5.2) * 0.0625 + 3) + 2) * kRounding * kContrast;
    const double difference =
        largestDifference(ours(volume, "diffuse:5:kappa=1.4142135623730951:dt=0.0625:g=exp"), itk_result);
    EXPECT_LE(difference, bound);
    RecordProperty(std::string("largest_difference_of_contrast_along_") + "ijk"[axis],
                   std::to_string(difference / kContrast * 1e6) + "e-6");
    EXPECT_GT(largestDifference(itk_result, reference::denseField(volume)), 0.1);
  }
}

// Central differences in the interior, per metre. ITK multiplies by 0.5 / h in float, we by 1 / 2h rounded: three
// roundings either way of differences up to the contrast.
TEST(Itk, GradientsAreEqualInside) {
  const Vec3 spacing_m(0.7e-3, 0.9e-3, 1.3e-3);
  const DenseField field = reference::denseField(noisyBall(kSize, spacing_m));
  const auto filter = itk::GradientImageFilter<Image, double, double>::New();
  filter->SetInput(imageOf(field));
  filter->Update();
  for (int k = 1; k + 1 < kSize.z(); ++k) {
    for (int j = 1; j + 1 < kSize.y(); ++j) {
      for (int i = 1; i + 1 < kSize.x(); ++i) {
        const auto itk_gradient = filter->GetOutput()->GetPixel({i, j, k});
        const auto gradient = reference::gradientAt(field, gradientOperator("central"), i, j, k);
        for (unsigned axis = 0; axis < 3; ++axis) {
          const double bound = 6 * kRounding * kContrast / (2 * spacing_m[static_cast<int>(axis)]);
          ASSERT_NEAR(gradient[axis], itk_gradient[axis] * 1e3, bound) << i << " " << j << " " << k;
        }
      }
    }
  }
}

// Maurer's distance is that to the centre of the nearest voxel on the object's rim, ours that to the isosurface between
// voxels. A rim voxel has a neighbour outside, so the surface passes within a voxel's diagonal of it; and from the
// nearest surface point, which lies in a cell with corners on both sides, a rim voxel is a diagonal away at most. So
// the two differ by one diagonal at most. Our own error is of the second order, 1/24 voxel here (filter_distance_test).
TEST(Itk, DistancesDifferByLessThanAVoxelsDiagonal) {
  const Vec3 spacing_m(0.7e-3, 0.9e-3, 1.3e-3);
  const Vec3i size(33, 30, 25);
  Lattice lattice;
  lattice.spacing_m = spacing_m;
  std::vector<float> values;
  for (int n = 0; n < size.prod(); ++n) {
    const Vec3 voxel = Vec3i(n % size.x(), n / size.x() % size.y(), n / size.x() / size.y()).cast<double>();
    const Vec3 from_m = (voxel - (size.cast<double>() - Vec3::Ones()) / 2).cwiseProduct(spacing_m);
    values.push_back(static_cast<float>(8e-3 - from_m.norm()) * 1e3F);
  }
  const Volume volume = Volume::fromDense(size, lattice, values, {});
  DenseField binary = reference::denseField(volume);
  for (float& value : binary.values) value = value > 0 ? 1.0F : 0.0F;
  const auto filter = itk::SignedMaurerDistanceMapImageFilter<Image, Image>::New();
  filter->SetUseImageSpacing(true);
  filter->SetSquaredDistance(false);
  filter->SetInsideIsPositive(true);
  filter->SetBackgroundValue(0);
  const DenseField maurer_mm = resultOf(*filter, binary);
  const DenseField distance_m = ours(volume, "distance:6", 0.0F);
  const double band_mm = 6 * 0.7;
  const double diagonal_mm = spacing_m.norm() * 1e3;
  double sum = 0;
  double largest = 0;
  int count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double ours_mm = 1e3 * distance_m.values[i];
    const double itks_mm = std::clamp<double>(maurer_mm.values[i], -band_mm, band_mm);
    ASSERT_LE(std::abs(ours_mm - itks_mm), diagonal_mm + 0.7 / 24);
    largest = std::max(largest, std::abs(ours_mm - itks_mm));
    if (std::abs(ours_mm) > 0.8 * band_mm) continue;
    sum += ours_mm - itks_mm;
    ++count;
  }
  // On average the surface lies between rim and outside, so by less than half a diagonal off the rim.
  EXPECT_LT(std::abs(sum / count), diagonal_mm / 2);
  RecordProperty("largest_difference_mm", std::to_string(largest));
  RecordProperty("mean_difference_mm", std::to_string(sum / count));
}

}  // namespace itk_filter_test
}  // namespace palpate
