// SPDX-License-Identifier: Apache-2.0
#include "engine/files/unpacker.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include "engine/files/whole_gzip.hpp"

namespace palpate {
namespace {

constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

}  // namespace

// The packed bytes, a block at a time.
class Unpacker::Input {
 public:
  Input(const std::string& path, std::uint64_t offset, std::uint64_t bytes)
      : descriptor_(open(path.c_str(), O_RDONLY | O_CLOEXEC)), offset_(offset), to_end_(bytes == kToEnd), left_(bytes) {
    if (descriptor_ < 0) fail(errno);
    if (lseek(descriptor_, static_cast<off_t>(offset), SEEK_SET) < 0) fail(errno);
  }
  ~Input() {
    if (descriptor_ >= 0) close(descriptor_);
  }
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  // Empty, with nothing read: see wholeGzip.
  [[nodiscard]] std::optional<WholeGzip> whole() const {
    return to_end_ ? wholeGzip(descriptor_, offset_) : std::nullopt;
  }

  // 0: the end.
  std::size_t read(char* to, std::size_t count) {
    count = std::min<std::uint64_t>(count, left_);
    ssize_t got = 0;
    do {
      got = count > 0 ? ::read(descriptor_, to, count) : 0;
    } while (got < 0 && errno == EINTR);
    if (got < 0) fail(errno);
    left_ -= static_cast<std::uint64_t>(got);
    return static_cast<std::size_t>(got);
  }

 private:
  [[noreturn]] static void fail(int why) { throw std::system_error(why, std::generic_category()); }

  static constexpr std::uint64_t kToEnd = std::numeric_limits<std::uint64_t>::max();

  int descriptor_;
  std::uint64_t offset_;
  bool to_end_;
  std::uint64_t left_;
};

struct Unpacker::State {
  State(const std::string& path, std::uint64_t offset, Packing packing_in, std::uint64_t bytes)
      : input(path, offset, bytes), packing(packing_in) {
    if (packing == Packing::kNone) return;
    block = std::make_unique_for_overwrite<Bytef[]>(kBlockBytes);
    // 15: the largest window; 16 more: gzip; 32 more: gzip or zlib, as the first bytes tell.
    if (inflateInit2(&stream, packing == Packing::kGzip ? 15 + 16 : 15 + 32) != Z_OK) throw std::bad_alloc();
  }
  ~State() {
    if (packing != Packing::kNone) inflateEnd(&stream);
  }
  State(const State&) = delete;
  State& operator=(const State&) = delete;

  // Whether there are packed bytes to read.
  bool fill() {
    if (stream.avail_in > 0) return true;
    stream.next_in = block.get();
    stream.avail_in = static_cast<uInt>(input.read(reinterpret_cast<char*>(block.get()), kBlockBytes));
    return stream.avail_in > 0;
  }

  // After the end of a member or stream.
  void goOnAfterEnd() {
    if (!fill()) {
      at_end = true;
    } else if (packing == Packing::kGzip && *stream.next_in == 0x1f) {
      inflateReset(&stream);
    } else {
      checkPadding();
      at_end = true;
    }
  }

  void checkPadding() {
    while (fill()) {
      const bool zeros = std::all_of(stream.next_in, stream.next_in + stream.avail_in, [](Bytef b) { return b == 0; });
      if (packing != Packing::kGzip || !zeros) {
        throw std::runtime_error("its compressed data end, and bytes follow that are no part of them");
      }
      stream.avail_in = 0;
    }
  }

  void step() {
    if (!fill()) throw std::runtime_error("its compressed data end early");
    const int result = inflate(&stream, Z_NO_FLUSH);
    if (result == Z_STREAM_END) return goOnAfterEnd();
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result != Z_OK && result != Z_BUF_ERROR) {
      throw std::runtime_error(
          fmt::format("its compressed data are damaged: {}", stream.msg != nullptr ? stream.msg : "no such stream"));
    }
  }

  Input input;
  Packing packing;
  std::unique_ptr<Bytef[]> block;
  z_stream stream = {};
  bool at_end = false;
  std::optional<WholeGzip> whole;
  std::size_t whole_at = 0;  // so many of its bytes were delivered
};

Unpacker::Unpacker(const std::string& path, std::uint64_t offset, Packing packing, std::uint64_t packed_bytes)
    : state_(std::make_unique<State>(path, offset, packing, packed_bytes)) {}
Unpacker::~Unpacker() = default;
Unpacker::Unpacker(Unpacker&&) noexcept = default;
Unpacker& Unpacker::operator=(Unpacker&&) noexcept = default;

bool Unpacker::unpackWhole() {
  if (state_->packing == Packing::kGzip) state_->whole = state_->input.whole();
  return state_->whole.has_value();
}

std::size_t Unpacker::read(char* to, std::size_t count) {
  std::size_t done = 0;
  State& state = *state_;
  if (state.whole) {
    done = std::min(count, state.whole->count - state.whole_at);
    std::copy_n(state.whole->bytes.get() + state.whole_at, done, to);
    state.whole_at += done;
    return done;
  }
  if (state.packing == Packing::kNone) {
    while (done < count) {
      const std::size_t got = state.input.read(to + done, count - done);
      if (got == 0) break;
      done += got;
    }
    return done;
  }
  while (done < count && !state.at_end) {
    const auto piece = static_cast<uInt>(std::min<std::size_t>(count - done, std::size_t{1} << 30));
    state.stream.next_out = reinterpret_cast<Bytef*>(to + done);
    state.stream.avail_out = piece;
    state.step();
    done += piece - state.stream.avail_out;
  }
  return done;
}

std::uint64_t Unpacker::drain() {
  std::vector<char> dropped(kBlockBytes);
  std::uint64_t total = 0;
  for (std::size_t got = 0; (got = read(dropped.data(), dropped.size())) > 0;) total += got;
  return total;
}

std::optional<std::string> inflated(std::string_view packed, std::size_t most_bytes) {
  z_stream stream = {};
  if (inflateInit2(&stream, -15) != Z_OK) throw std::bad_alloc();  // 15: the largest window; negative: no header
  const std::unique_ptr<z_stream, int (*)(z_stream*)> owner(&stream, inflateEnd);
  const std::unique_ptr<char[]> block = std::make_unique_for_overwrite<char[]>(kBlockBytes);
  std::string out;
  for (int result = Z_OK; result != Z_STREAM_END;) {
    if (stream.avail_in == 0 && !packed.empty()) {
      const std::string_view piece = packed.substr(0, kBlockBytes);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(piece.data()));  // zlib does not write there
      stream.avail_in = static_cast<uInt>(piece.size());
      packed.remove_prefix(piece.size());
    }
    stream.next_out = reinterpret_cast<Bytef*>(block.get());
    stream.avail_out = kBlockBytes;
    result = inflate(&stream, Z_NO_FLUSH);
    if (result == Z_MEM_ERROR) throw std::bad_alloc();
    if (result != Z_OK && result != Z_STREAM_END) return {};  // Z_BUF_ERROR: it ends early
    const std::size_t got = kBlockBytes - stream.avail_out;
    if (got > most_bytes - out.size()) return {};
    out.append(block.get(), got);
  }
  const std::string_view rest(packed.data() - stream.avail_in, packed.size() + stream.avail_in);
  if (!rest.empty() && rest != std::string_view("\0", 1)) return {};
  return out;
}

bool isGzip(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return file.get() == 0x1f && file.get() == 0x8b;
}

}  // namespace palpate
