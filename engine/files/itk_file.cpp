// SPDX-License-Identifier: Apache-2.0
// The module "itk".
#include "engine/files/itk_file.hpp"

#include <stdexcept>

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>
#include <itkObject.h>
#include <nifti1_io.h>

#include "engine/files/quiet.hpp"

namespace palpate {
namespace {

itk::ImageIOBase::Pointer makeIo(ItkReader reader) {
  switch (reader) {
    case ItkReader::kNrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case ItkReader::kNifti:
      return itk::NiftiImageIO::New().GetPointer();
    case ItkReader::kMeta:
      return itk::MetaImageIO::New().GetPointer();
  }
  return nullptr;
}

// Runs `work` with the screen caught and ITK's exceptions turned into one line.
template <class Work>
void quietly(const Work& work) {
  const Quiet quiet;
  itk::Object::SetGlobalWarningDisplay(false);
  nifti_set_debug_level(0);  // the C library prints with fprintf
  try {
    work();
  } catch (const itk::ExceptionObject& failure) {
    throw std::runtime_error(shortReason(failure.GetDescription()));
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& failure) {
    throw std::runtime_error(shortReason(failure.what()));
  }
}

std::optional<ValueType> valueTypeOf(itk::IOComponentEnum component) {
  using Component = itk::IOComponentEnum;
  switch (component) {
    case Component::UCHAR:
      return ValueType::kUint8;
    case Component::CHAR:
      return ValueType::kInt8;
    case Component::USHORT:
      return ValueType::kUint16;
    case Component::SHORT:
      return ValueType::kInt16;
    case Component::UINT:
      return ValueType::kUint32;
    case Component::INT:
      return ValueType::kInt32;
    case Component::ULONG:
    case Component::ULONGLONG:
      return ValueType::kUint64;
    case Component::LONG:
    case Component::LONGLONG:
      return ValueType::kInt64;
    case Component::FLOAT:
      return ValueType::kFloat32;
    case Component::DOUBLE:
      return ValueType::kFloat64;
    default:
      return {};
  }
}

ItkHeader headerOf(const itk::ImageIOBase& image) {
  ItkHeader header;
  header.components = image.GetNumberOfComponents();
  header.type = valueTypeOf(image.GetComponentType());
  const unsigned axes = image.GetNumberOfDimensions();
  for (unsigned axis = 0; axis < axes; ++axis) {
    header.dimensions.push_back(static_cast<std::int64_t>(image.GetDimensions(axis)));
    if (axis >= 3) continue;
    header.origin[axis] = image.GetOrigin(axis);
    header.spacing[axis] = image.GetSpacing(axis);
    const std::vector<double> direction = image.GetDirection(axis);
    for (std::size_t row = 0; row < 3 && row < direction.size(); ++row) header.direction[axis][row] = direction[row];
  }
  return header;
}

itk::ImageIORegion wholeRegion(const itk::ImageIOBase& image) {
  const unsigned axes = image.GetNumberOfDimensions();
  itk::ImageIORegion region(axes);
  for (unsigned axis = 0; axis < axes; ++axis) region.SetSize(axis, image.GetDimensions(axis));
  return region;
}

class OpenItkFile final : public ItkFile {
 public:
  OpenItkFile(ItkReader reader, const std::string& path) {
    quietly([&] {
      image_ = makeIo(reader);
      image_->SetFileName(path);
      image_->ReadImageInformation();
      header_ = headerOf(*image_);
    });
  }

  [[nodiscard]] const ItkHeader& header() const noexcept override { return header_; }

  void read(std::span<char> values) override {
    quietly([&] {
      std::size_t bytes = header_.type ? byteSize(*header_.type) * header_.components : 0;
      for (const std::int64_t size : header_.dimensions) bytes *= static_cast<std::size_t>(size);
      if (bytes != values.size()) throw std::runtime_error("its header has changed since it was read");
      image_->SetIORegion(wholeRegion(*image_));
      image_->Read(values.data());
    });
  }

 private:
  itk::ImageIOBase::Pointer image_;
  ItkHeader header_;
};

std::unique_ptr<ItkFile> open(ItkReader reader, const std::string& path) {
  return std::make_unique<OpenItkFile>(reader, path);
}

}  // namespace
}  // namespace palpate

extern "C" const palpate::ItkModule palpate_itk = {palpate::open};
