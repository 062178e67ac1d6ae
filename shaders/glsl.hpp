// SPDX-License-Identifier: Apache-2.0
// shaders/glsl.hpp: the part of GLSL that the *.math.glsl files use, in C++, so that C++ can compile their text
// (kernel_text.hpp). Operations on vec4 go element by element. Each rounds as GLSL does with `precise`. Any thread.
#pragma once

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

namespace palpate::glsl {

using uint = std::uint32_t;

template <typename T>
struct Vec4 {
  std::array<T, 4> e{};
  constexpr Vec4() = default;
  explicit constexpr Vec4(T all) : e{all, all, all, all} {}
  constexpr Vec4(T x, T y, T z, T w) : e{x, y, z, w} {}
  template <typename U>
  explicit constexpr Vec4(const Vec4<U>& v)
      : e{static_cast<T>(v[0]), static_cast<T>(v[1]), static_cast<T>(v[2]), static_cast<T>(v[3])} {}
  constexpr T& operator[](int i) noexcept { return e[static_cast<std::size_t>(i)]; }
  constexpr const T& operator[](int i) const noexcept { return e[static_cast<std::size_t>(i)]; }
};
using vec4 = Vec4<float>;
using ivec4 = Vec4<int>;
using uvec4 = Vec4<uint>;
using bvec4 = Vec4<bool>;

struct vec3 {
  float x = 0, y = 0, z = 0;
};
inline vec3 operator+(const vec3& a, const vec3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline vec3 operator-(const vec3& a, const vec3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline vec3 operator*(const vec3& a, float b) {
  return {a.x * b, a.y * b, a.z * b};
}

// Applies `function` to the first elements of all vectors, then to the second ones, and so on.
template <typename Function, typename... Vectors>
constexpr auto each(const Function& function, const Vectors&... vectors) {
  using Result = decltype(function(vectors[0]...));
  return Vec4<Result>(function(vectors[0]...), function(vectors[1]...), function(vectors[2]...),
                      function(vectors[3]...));
}

inline vec4 operator+(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x + y; }, a, b);
}
inline vec4 operator-(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x - y; }, a, b);
}
inline vec4 operator*(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x * y; }, a, b);
}
inline vec4 operator/(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x / y; }, a, b);
}
inline vec4 operator+(float a, const vec4& b) {
  return vec4(a) + b;
}
inline vec4 operator+(const vec4& a, float b) {
  return a + vec4(b);
}
inline vec4 operator-(float a, const vec4& b) {
  return vec4(a) - b;
}
inline vec4 operator-(const vec4& a, float b) {
  return a - vec4(b);
}
inline vec4 operator*(const vec4& a, float b) {
  return a * vec4(b);
}
inline vec4 operator/(const vec4& a, float b) {
  return a / vec4(b);
}
inline vec4 operator*(float a, const vec4& b) {
  return vec4(a) * b;
}
inline vec4 operator-(const vec4& a) {
  return each([](float x) { return -x; }, a);
}

inline ivec4 operator-(const ivec4& a, int b) {
  return each([b](int x) { return x - b; }, a);
}
inline uvec4 operator&(const uvec4& a, const uvec4& b) {
  return each([](uint x, uint y) { return x & y; }, a, b);
}

inline bvec4 lessThan(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x < y; }, a, b);
}
inline bvec4 lessThanEqual(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x <= y; }, a, b);
}
inline bvec4 greaterThan(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x > y; }, a, b);
}
inline bvec4 greaterThanEqual(const vec4& a, const vec4& b) {
  return each([](float x, float y) { return x >= y; }, a, b);
}
// Elements of b where `second` is true, of a elsewhere.
inline vec4 mix(const vec4& a, const vec4& b, const bvec4& second) {
  return each([](float x, float y, bool is_second) { return is_second ? y : x; }, a, b, second);
}

inline float sqrt(float a) {
  return std::sqrt(a);
}
inline vec4 sqrt(const vec4& a) {
  return each([](float x) { return std::sqrt(x); }, a);
}
inline float abs(float a) {
  return std::fabs(a);
}
inline float floor(float a) {
  return std::floor(a);
}
inline uint floatBitsToUint(float a) {
  return std::bit_cast<uint>(a);
}
inline float uintBitsToFloat(uint a) {
  return std::bit_cast<float>(a);
}
inline int floatBitsToInt(float a) {
  return std::bit_cast<int>(a);
}
inline float intBitsToFloat(int a) {
  return std::bit_cast<float>(a);
}
inline int min(int a, int b) {
  return a < b ? a : b;
}
inline int max(int a, int b) {
  return a > b ? a : b;
}
inline float min(float a, float b) {
  return b < a ? b : a;
}
inline float max(float a, float b) {
  return a < b ? b : a;
}
inline ivec4 min(const ivec4& a, const ivec4& b) {
  return each([](int x, int y) { return min(x, y); }, a, b);
}
inline ivec4 max(const ivec4& a, const ivec4& b) {
  return each([](int x, int y) { return max(x, y); }, a, b);
}
inline int clamp(int a, int low, int high) {
  return min(max(a, low), high);
}
inline float clamp(float a, float low, float high) {
  const float raised = a < low ? low : a;
  return raised > high ? high : raised;
}
inline vec4 clamp(const vec4& a, float low, float high) {
  return each([=](float x) { return clamp(x, low, high); }, a);
}

}  // namespace palpate::glsl
