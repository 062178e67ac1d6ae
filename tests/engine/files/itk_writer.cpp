// SPDX-License-Identifier: Apache-2.0
#include "tests/engine/files/itk_writer.hpp"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

namespace palpate {
namespace {

itk::ImageIOBase::Pointer makeIo(ItkWriter writer) {
  if (writer == ItkWriter::kNrrd) return itk::NrrdImageIO::New().GetPointer();
  if (writer == ItkWriter::kNifti) return itk::NiftiImageIO::New().GetPointer();
  return itk::MetaImageIO::New().GetPointer();
}

}  // namespace

void writeWithItk(ItkWriter writer, const std::string& path, const ItkImage& image, bool compressed) {
  const itk::ImageIOBase::Pointer io = makeIo(writer);
  const auto axes = static_cast<unsigned>(image.size.size());
  io->SetNumberOfDimensions(axes);
  itk::ImageIORegion region(axes);
  for (unsigned axis = 0; axis < axes; ++axis) {
    std::vector<double> direction(axes, 0.0);
    direction[axis] = 1;
    if (axis < 3) {
      for (std::size_t row = 0; row < 3 && row < axes; ++row) direction[row] = image.direction[axis][row];
    }
    io->SetDimensions(axis, image.size[axis]);
    io->SetSpacing(axis, axis < 3 ? image.spacing_mm[axis] : 1.0);
    io->SetOrigin(axis, axis < 3 ? image.origin_mm[axis] : 0.0);
    io->SetDirection(axis, direction);
    region.SetSize(axis, image.size[axis]);
  }
  io->SetPixelType(image.components == 1 ? itk::IOPixelEnum::SCALAR : itk::IOPixelEnum::VECTOR);
  io->SetNumberOfComponents(image.components);
  io->SetComponentType(itk::IOComponentEnum::SHORT);
  io->SetUseCompression(compressed);
  io->SetIORegion(region);
  io->SetFileName(path);
  io->WriteImageInformation();
  io->Write(image.values.data());
}

}  // namespace palpate
