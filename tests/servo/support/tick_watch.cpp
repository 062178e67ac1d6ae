// SPDX-License-Identifier: Apache-2.0
#include "support/tick_watch.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstdlib>

#include <dlfcn.h>
#include <pthread.h>
#include <semaphore.h>

namespace {

// Initial-exec: reading it must not itself allocate.
thread_local bool watching __attribute__((tls_model("initial-exec"))) = false;
std::atomic<long> allocations{0}, frees{0}, locks{0};

void note(std::atomic<long>& count) noexcept {
  if (watching) count.fetch_add(1, std::memory_order_relaxed);
}

}  // namespace

#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
// Declared here: GCC ships the function but not its header.
extern "C" int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void*, std::size_t),
                                                         void (*freed)(const volatile void*));

namespace {
constexpr bool kSeesLocks = false;
[[maybe_unused]] const int kInstalled =
    __sanitizer_install_malloc_and_free_hooks([](const volatile void*, std::size_t) { note(allocations); },
                                              [](const volatile void* block) {
                                                if (block != nullptr) note(frees);
                                              });
}  // namespace
#else
namespace {
constexpr bool kSeesLocks = true;

// The function that an interposed one stands before.
template <class Function>
Function* behind(const char* name) noexcept {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}
}  // namespace

// The functions of glibc behind malloc and its kin.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
  note(allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note(allocations);
  return __libc_calloc(count, size);
}
void* realloc(void* block, std::size_t size) {
  note(allocations);
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  note(allocations);
  *block = __libc_memalign(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}
void free(void* block) {
  if (block != nullptr) note(frees);
  __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
  static const auto real = behind<int(pthread_mutex_t*)>("pthread_mutex_lock");
  note(locks);
  return real(mutex);
}
int pthread_mutex_trylock(pthread_mutex_t* mutex) {
  static const auto real = behind<int(pthread_mutex_t*)>("pthread_mutex_trylock");
  note(locks);
  return real(mutex);
}
int pthread_mutex_timedlock(pthread_mutex_t* mutex, const timespec* until) {
  static const auto real = behind<int(pthread_mutex_t*, const timespec*)>("pthread_mutex_timedlock");
  note(locks);
  return real(mutex, until);
}
int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
  static const auto real = behind<int(pthread_rwlock_t*)>("pthread_rwlock_rdlock");
  note(locks);
  return real(lock);
}
int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
  static const auto real = behind<int(pthread_rwlock_t*)>("pthread_rwlock_wrlock");
  note(locks);
  return real(lock);
}
int pthread_spin_lock(pthread_spinlock_t* lock) {
  static const auto real = behind<int(pthread_spinlock_t*)>("pthread_spin_lock");
  note(locks);
  return real(lock);
}
int pthread_cond_wait(pthread_cond_t* condition, pthread_mutex_t* mutex) {
  static const auto real = behind<int(pthread_cond_t*, pthread_mutex_t*)>("pthread_cond_wait");
  note(locks);
  return real(condition, mutex);
}
int sem_wait(sem_t* semaphore) {
  static const auto real = behind<int(sem_t*)>("sem_wait");
  note(locks);
  return real(semaphore);
}
}
#endif

namespace palpate {

void TickWatch::begin() noexcept {
  allocations = frees = locks = 0;
  watching = true;
}
void TickWatch::end() noexcept {
  watching = false;
}
TickWatch::Seen TickWatch::seen() noexcept {
  return {allocations, frees, locks};
}
bool TickWatch::seesLocks() noexcept {
  return kSeesLocks;
}

}  // namespace palpate
