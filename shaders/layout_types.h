// SPDX-License-Identifier: Apache-2.0
// shaders/layout_types.h: macros that let C++ and GLSL read the same *.layout.h. Shared structs hold 4-byte scalars
// only, so std430 and C++ agree on every offset. Each layout file checks the sizes of its structs.
#ifndef PALPATE_LAYOUT_TYPES_H
#define PALPATE_LAYOUT_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#define PALPATE_LAYOUT_BEGIN  \
  namespace palpate::layout { \
  using uint = std::uint32_t;
#define PALPATE_LAYOUT_END }
#define PALPATE_LAYOUT_CHECK(Type, bytes) static_assert(sizeof(Type) == (bytes), #Type " must match its GLSL layout");
#define PALPATE_PUSH_CHECK(Type) \
  static_assert(sizeof(Type) <= 128, #Type " exceeds what Vulkan guarantees for push constants");
#define PALPATE_TEXT inline  // marks functions that both compile (kernel_text.hpp)
#define PALPATE_IN_ARRAY(Type, name, count) const Type(&(name))[count]
#define PALPATE_INOUT_ARRAY(Type, name, count) Type(&(name))[count]
#else
#define PALPATE_TEXT
#define PALPATE_IN_ARRAY(Type, name, count) Type name[count]
#define PALPATE_INOUT_ARRAY(Type, name, count) inout Type name[count]
#define PALPATE_LAYOUT_BEGIN
#define PALPATE_LAYOUT_END
#define PALPATE_LAYOUT_CHECK(Type, bytes)
#define PALPATE_PUSH_CHECK(Type)
#endif

#endif
