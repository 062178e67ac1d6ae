# Compiler rules for every target: C++20, warnings are errors, no contraction, optional sanitizers.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

find_program(PALPATE_CCACHE ccache)
if(PALPATE_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${PALPATE_CCACHE})
endif()

set(PALPATE_SANITIZE "" CACHE STRING "Sanitizers, as in -fsanitize=")
option(PALPATE_LIBFUZZER "Fuzz targets are libFuzzer programs; needs clang" OFF)
option(PALPATE_LINT "clang-tidy, which is clang, reads the compile commands, whichever compiler they are for" OFF)

add_library(palpate_compiler INTERFACE)
target_compile_options(palpate_compiler INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Wold-style-cast
  $<$<CXX_COMPILER_ID:GNU>:-Werror>  # other compilers have other warnings
  # A CPU twin must round as its kernel does, so a*b+c stays two operations.
  -ffp-contract=off)
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  # GCC 12 makes vectors of neighbouring doubles and then omits their rounding to float and back (tests/base/rounding_test.cpp).
  target_compile_options(palpate_compiler INTERFACE -fno-tree-slp-vectorize)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # GCC 12 reports overlapping copies in std::string's operator+ that cannot happen (GCC bug 105329),
  # and impossible bounds (GCC bug 105651).
  target_compile_options(palpate_compiler INTERFACE -Wno-restrict -Wno-array-bounds -Wno-stringop-overflow -Wno-stringop-overread)
endif()
if(PALPATE_SANITIZE)
  target_compile_options(palpate_compiler INTERFACE -fsanitize=${PALPATE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(palpate_compiler INTERFACE -fsanitize=${PALPATE_SANITIZE})
endif()
if(PALPATE_LIBFUZZER)
  target_compile_options(palpate_compiler INTERFACE -fsanitize=fuzzer-no-link)
endif()
find_program(PALPATE_LLD ld.lld)
if(PALPATE_LLD)
  target_link_options(palpate_compiler INTERFACE -fuse-ld=lld)
endif()
