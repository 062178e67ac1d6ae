// SPDX-License-Identifier: Apache-2.0
// cmake/itk_for_clang.hpp: lets clang compile ITK's headers. As Debian packages them they know GCC alone and stop any
// other compiler. This file is included before them and makes clang look like a GCC with the same features.
#pragma once
#pragma GCC system_header  // no warnings about the compiler's own macros

#pragma push_macro("__clang__")
#pragma push_macro("__GNUC__")
#pragma push_macro("__GNUC_MINOR__")
#undef __clang__
#undef __GNUC__
#undef __GNUC_MINOR__
#define __GNUC__ 12
#define __GNUC_MINOR__ 2
#include <itk_compiler_detection.h>
#pragma pop_macro("__GNUC_MINOR__")
#pragma pop_macro("__GNUC__")
#pragma pop_macro("__clang__")
