// SPDX-License-Identifier: Apache-2.0
#include "engine/files/raw_block.hpp"

#include <cerrno>
#include <memory>
#include <span>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "engine/field/raw_values.hpp"

namespace palpate {
namespace {

// A file that several threads may read at once.
class File {
 public:
  explicit File(const std::string& path) : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), path);
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  void read(std::uint64_t offset, std::span<char> bytes) const {
    while (!bytes.empty()) {
      const ssize_t got = pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) throw std::system_error(got < 0 ? errno : EIO, std::generic_category(), "the file ends early");
      bytes = bytes.subspan(static_cast<std::size_t>(got));
      offset += static_cast<std::uint64_t>(got);
    }
  }

 private:
  int descriptor_;
};

struct Block {
  Block(const RawBlock& raw, ValueType type_in, const Vec3i& size_in, double slope_in, double intercept_in,
        RoundedNumbers* rounded_in)
      : file(raw.path),
        offset(raw.offset),
        swapped(raw.swapped),
        type(type_in),
        size(size_in),
        slope(slope_in),
        intercept(intercept_in),
        rounded(rounded_in) {}
  File file;
  std::uint64_t offset;
  bool swapped;
  ValueType type;
  Vec3i size;
  double slope, intercept;
  RoundedNumbers* rounded;
};

// The bricks of one layer. A row of bricks is read as a small volume of its own.
class Layer {
 public:
  Layer(std::shared_ptr<const Block> block, int bk) : block_(std::move(block)), bk_(bk) {}

  bool operator()(const Vec3i& brick, float* values) {
    if (brick.y() != row_) readRow(brick.y());
    return bricks_(Vec3i(brick.x(), 0, 0), values);
  }

 private:
  void readRow(int bj) {
    const Vec3i first(0, bj * kBrickSize, bk_ * kBrickSize);
    Vec3i size = (block_->size - first).cwiseMin(kBrickSize);
    size.x() = block_->size.x();
    const std::size_t line_bytes = static_cast<std::size_t>(size.x()) * byteSize(block_->type);
    const std::size_t slice_bytes = static_cast<std::size_t>(size.y()) * line_bytes;
    raw_.resize(static_cast<std::size_t>(size.z()) * slice_bytes);
    for (int k = 0; k < size.z(); ++k) {
      const auto line = static_cast<std::uint64_t>(first.z() + k) * static_cast<std::uint64_t>(block_->size.y()) +
                        static_cast<std::uint64_t>(first.y());
      block_->file.read(block_->offset + line * line_bytes,
                        std::span(raw_).subspan(static_cast<std::size_t>(k) * slice_bytes, slice_bytes));
    }
    if (block_->swapped) swapBytes(raw_, block_->type);
    bricks_ = rawBricks(raw_, block_->type, size, block_->slope, block_->intercept, block_->rounded);
    row_ = bj;
  }

  std::shared_ptr<const Block> block_;
  int bk_;
  int row_ = -1;
  std::vector<char> raw_;
  Volume::BrickSource bricks_;
};

}  // namespace

std::function<Volume::BrickSource(int bk)> layersOf(const RawBlock& block, ValueType type, const Vec3i& size,
                                                    double slope, double intercept, RoundedNumbers* rounded) {
  const auto shared = std::make_shared<const Block>(block, type, size, slope, intercept, rounded);
  return [shared](int bk) -> Volume::BrickSource {
    // A std::function may be copied, but the row that a layer holds must not be copied with it.
    const auto layer = std::make_shared<Layer>(shared, bk);
    return [layer](const Vec3i& brick, float* values) { return (*layer)(brick, values); };
  };
}

}  // namespace palpate
