// SPDX-License-Identifier: Apache-2.0
// gzip through libarchive. An exception of the sink must not pass through C code, so it is kept until C has returned.
#include <exception>
#include <stdexcept>
#include <utility>

#include <archive.h>
#include <archive_entry.h>

#include "engine/files/writers.hpp"

namespace palpate {

struct GzipSink::State {
  struct Free {
    void operator()(archive* packed) const noexcept {
      archive_write_fail(packed);  // writes nothing more to the sink; without effect after finish()
      archive_write_free(packed);
    }
  };
  ByteSink sink;
  std::exception_ptr trouble;
  std::unique_ptr<archive, Free> packed{archive_write_new()};  // last member: freeing it uses the others

  void check(la_ssize_t result) {
    if (trouble) std::rethrow_exception(std::exchange(trouble, nullptr));
    if (result < 0) throw std::runtime_error("compressing failed");
  }
};

GzipSink::GzipSink(const ByteSink& sink) : state_(std::make_unique<State>()) {
  state_->sink = sink;
  archive* packed = state_->packed.get();
  if (packed == nullptr) throw std::bad_alloc();
  state_->check(archive_write_add_filter_gzip(packed));
  state_->check(archive_write_set_filter_option(packed, "gzip", "compression-level", "4"));
  state_->check(archive_write_set_filter_option(packed, "gzip", "timestamp", nullptr));  // the same file every time
  state_->check(archive_write_set_format_raw(packed));
  state_->check(archive_write_set_bytes_per_block(packed, 0));
  const auto forward = [](archive*, void* state, const void* bytes, std::size_t count) -> la_ssize_t {
    auto& to = *static_cast<State*>(state);
    try {
      to.sink({static_cast<const char*>(bytes), count});
      return static_cast<la_ssize_t>(count);
    } catch (...) {
      to.trouble = std::current_exception();
      return -1;
    }
  };
  state_->check(archive_write_open(packed, state_.get(), nullptr, forward, nullptr));
  archive_entry* entry = archive_entry_new();
  archive_entry_set_filetype(entry, AE_IFREG);
  const int result = archive_write_header(packed, entry);
  archive_entry_free(entry);
  state_->check(result);
}

GzipSink::~GzipSink() = default;

void GzipSink::write(std::string_view bytes) {
  constexpr std::size_t kPiece = std::size_t{1} << 20;
  for (; !bytes.empty(); bytes.remove_prefix(std::min(kPiece, bytes.size()))) {
    state_->check(archive_write_data(state_->packed.get(), bytes.data(), std::min(kPiece, bytes.size())));
  }
}

void GzipSink::finish() {
  state_->check(archive_write_close(state_->packed.get()));
}

}  // namespace palpate
