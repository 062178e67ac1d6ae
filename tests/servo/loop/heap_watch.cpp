// SPDX-License-Identifier: Apache-2.0
#include "heap_watch.hpp"

#include <atomic>
#include <cstddef>
#include <cstdlib>

namespace {

// Initial-exec: reading it must not itself allocate.
thread_local bool watching __attribute__((tls_model("initial-exec"))) = false;
std::atomic<long> seen{0};

void note() noexcept {
  if (watching) seen.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
// Declared here: GCC ships the function but not its header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void*, std::size_t),
                                                         void (*freed)(const volatile void*));

namespace {
[[maybe_unused]] const int kInstalled = __sanitizer_install_malloc_and_free_hooks(
    [](const volatile void*, std::size_t) { note(); }, [](const volatile void*) {});
}
#else
// The functions of glibc behind malloc and its kin.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) {
  note();
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note();
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  note();
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note();
  return __libc_memalign(alignment, size);
}
}
#endif

namespace palpate {

void HeapWatch::begin() noexcept {
  seen = 0;
  watching = true;
}
void HeapWatch::end() noexcept {
  watching = false;
}
long HeapWatch::count() noexcept {
  return seen;
}

}  // namespace palpate
