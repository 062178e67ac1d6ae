// SPDX-License-Identifier: Apache-2.0
#include <itkBilateralImageFilter.h>
#include <itkCovariantVector.h>
#include <itkCurvatureAnisotropicDiffusionImageFilter.h>
#include <itkDiscreteGaussianImageFilter.h>
#include <itkFlatStructuringElement.h>
#include <itkGradientAnisotropicDiffusionImageFilter.h>
#include <itkGradientImageFilter.h>
#include <itkGrayscaleMorphologicalClosingImageFilter.h>
#include <itkImage.h>
#include <itkMedianImageFilter.h>
#include <itkMultiThreaderBase.h>

#include "apps/rivals/itk_jobs.hpp"
#include "base/error.hpp"
#include "base/units.hpp"

namespace palpate {
namespace {

using Image = itk::Image<float, 3>;
using Vectors = itk::Image<itk::CovariantVector<float, 3>, 3>;
using Box = itk::FlatStructuringElement<3>;

Image::Pointer imageOf(const RivalField& field) {
  Image::Pointer image = Image::New();
  Image::SizeType size;
  Image::SpacingType spacing_mm;
  for (unsigned axis = 0; axis < 3; ++axis) {
    size[axis] = static_cast<itk::SizeValueType>(field.size[static_cast<int>(axis)]);
    spacing_mm[axis] = field.spacing_m[static_cast<int>(axis)] / kMetresPerMillimetre;
  }
  image->SetRegions(Image::RegionType(size));
  image->SetSpacing(spacing_mm);
  // In-place filters are switched to separate outputs, so nothing writes here.
  auto* densities = const_cast<float*>(field.densities.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
  image->GetPixelContainer()->SetImportPointer(densities, field.densities.size(), false);
  return image;
}

template <class Output>
void copyTo(const Output& output, std::vector<float>& result) {
  const std::size_t components = output.GetNumberOfComponentsPerPixel();
  const auto* first = reinterpret_cast<const float*>(output.GetBufferPointer());
  result.assign(first, first + components * output.GetLargestPossibleRegion().GetNumberOfPixels());
}

// Makes a new filter for each run; `prepare` sets its parameters.
template <class Filter>
Rival rival(const std::string& way, const Image::Pointer& image, const std::function<void(Filter&)>& prepare) {
  return {"ITK", way, [=](std::vector<float>* result) {
            try {
              typename Filter::Pointer filter = Filter::New();
              filter->SetInput(image);
              prepare(*filter);
              const RunCost cost = costOf([&] { filter->Update(); });
              if (result != nullptr) copyTo(*filter->GetOutput(), *result);
              return cost;
            } catch (const itk::ExceptionObject& failure) {
              throw Error(Error::Code::kOutOfMemory, "ITK " + way, failure.GetDescription(),
                          "give the machine more memory");
            }
          }};
}

Rival closing(const char* algorithm, itk::MathematicalMorphologyEnums::Algorithm which, const Image::Pointer& image) {
  using Filter = itk::GrayscaleMorphologicalClosingImageFilter<Image, Image, Box>;
  const std::string way = std::string("GrayscaleMorphologicalClosingImageFilter, box, ") + algorithm;
  return rival<Filter>(way, image, [which](Filter& filter) {
    Box::RadiusType radius;
    radius.Fill(1);
    filter.SetKernel(Box::Box(radius));  // before the algorithm: a kernel chooses one
    filter.SetAlgorithm(which);
    filter.SafeBorderOff();  // which pads the volume; a box needs no padding
  });
}

template <class Filter>
Rival diffusion(const std::string& way, const Image::Pointer& image) {
  return rival<Filter>(way + ", 5 iterations", image, [](Filter& filter) {
    constexpr double kStable = 1.0 / 16;  // mm^2 for voxels of 1 mm
    filter.InPlaceOff();
    filter.SetNumberOfIterations(5);
    filter.SetTimeStep(kStable);
    filter.SetConductanceParameter(1);
  });
}

}  // namespace

std::vector<Rival> itkJobs(const std::string& job, const RivalField& field, unsigned threads) {
  itk::MultiThreaderBase::SetGlobalMaximumNumberOfThreads(threads);
  itk::MultiThreaderBase::SetGlobalDefaultNumberOfThreads(threads);
  const Image::Pointer image = imageOf(field);
  using Algorithm = itk::MathematicalMorphologyEnums::Algorithm;
  if (job == "gradient central") {
    using Filter = itk::GradientImageFilter<Image, float, float, Vectors>;
    return {rival<Filter>("GradientImageFilter", image, [](Filter&) {})};
  }
  if (job == "gaussian:1.5") {
    using Filter = itk::DiscreteGaussianImageFilter<Image, Image>;
    return {rival<Filter>("DiscreteGaussianImageFilter, 11 taps", image, [](Filter& filter) {
      filter.SetUseImageSpacing(false);
      filter.SetVariance(1.5 * 1.5);
      filter.SetMaximumError(1e-3);  // which ends the kernel at five voxels, as three sigmas do
      filter.SetMaximumKernelWidth(11);
    })};
  }
  if (job == "median:1") {
    using Filter = itk::MedianImageFilter<Image, Image>;
    return {rival<Filter>("MedianImageFilter", image, [](Filter& filter) {
      Filter::InputSizeType radius;
      radius.Fill(1);
      filter.SetRadius(radius);
    })};
  }
  if (job == "close:1") {
    return {closing("BASIC", Algorithm::BASIC, image), closing("VHGW", Algorithm::VHGW, image),
            closing("ANCHOR", Algorithm::ANCHOR, image)};
  }
  if (job == "diffuse:5:kappa=200") {
    return {diffusion<itk::GradientAnisotropicDiffusionImageFilter<Image, Image>>(
                "GradientAnisotropicDiffusionImageFilter", image),
            diffusion<itk::CurvatureAnisotropicDiffusionImageFilter<Image, Image>>(
                "CurvatureAnisotropicDiffusionImageFilter", image)};
  }
  if (job == "bilateral:1:range=200") {
    using Filter = itk::BilateralImageFilter<Image, Image>;
    return {rival<Filter>("BilateralImageFilter, 5^3", image, [](Filter& filter) {
      Filter::SizeType radius;
      radius.Fill(2);
      filter.SetDomainSigma(1.0);
      filter.SetRangeSigma(200);
      filter.SetAutomaticKernelSize(false);
      filter.SetRadius(radius);
    })};
  }
  return {};
}

}  // namespace palpate
