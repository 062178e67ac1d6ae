// SPDX-License-Identifier: Apache-2.0
// engine/field/value_type.hpp: the number types that volume files hold. Includes no Eigen, for
// engine/files/itk_file.hpp. Any thread.
#pragma once

#include <cstddef>
#include <string>

namespace palpate {

enum class ValueType { kUint8, kInt8, kUint16, kInt16, kUint32, kInt32, kUint64, kInt64, kFloat32, kFloat64 };

[[nodiscard]] std::size_t byteSize(ValueType type) noexcept;
[[nodiscard]] std::string nameOf(ValueType type);  // "int16"

}  // namespace palpate
