# palpate_test(servo_window_exchange SOURCES exchange_test.cpp DEPENDS servo_window [LIBRARIES ...] [USES ...]
#              [LABELS short-asan-ubsan short-tsan] [GPU] [FAST])
# A program of its own, and one test that runs it. It sees the rooms that it names and all rooms that those name. GPU: it runs
# under the Vulkan validation layer, and any message of that layer fails the test.
#
# palpate_tests(servo_objects TESTS shapes hybrid ... [SOURCES helper.cpp ...] and the rest as above)
# One program for several test files, since most of its build time goes into headers and linking. For each x of TESTS there
# is a test servo_objects_x that runs the tests in x_test.cpp. Each file has a namespace of its own name, so that several can
# be compiled at once.
#
# A label short-PRESET makes the test part of the short sanitizer run of `./dev test` under that preset. The target of the same
# name builds those tests.
find_package(GTest REQUIRED)
set(PALPATE_TEST_TIMEOUT 300)
if(PALPATE_SANITIZE)
  set(PALPATE_TEST_TIMEOUT 1200)
endif()
add_custom_target(short-asan-ubsan)
add_custom_target(short-tsan)

# Most tests compute next to nothing themselves, and without optimisation they compile in half the time. FAST: optimised, for
# tests that sample formulas by the million.
set(PALPATE_TEST_OPTIONS -O0)
set(PALPATE_FAST_TEST_OPTIONS $<$<CONFIG:Release>:-O2>)

# Headers that almost every test includes, parsed once for each kind of test. These targets are executables, since precompiled
# headers need the code model of the tests.
function(palpate_test_pch target)
  add_executable(${target} ${PROJECT_SOURCE_DIR}/tests/support/pch.cpp)
  palpate_use_rooms(${target} base)
  target_link_libraries(${target} PRIVATE palpate_compiler GTest::gmock)
  target_precompile_headers(${target} PRIVATE <gmock/gmock.h> <gtest/gtest.h> <Eigen/Geometry> <fmt/format.h>)
  target_compile_options(${target} PRIVATE ${ARGN})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test-bin EXCLUDE_FROM_ALL ON)
endfunction()
palpate_test_pch(palpate_test_pch ${PALPATE_TEST_OPTIONS})
palpate_test_pch(palpate_fast_test_pch ${PALPATE_FAST_TEST_OPTIONS})

# Helpers of tests are included by their path: "tests/engine/files/samples.hpp".
set(PALPATE_TEST_ROOT ${CMAKE_BINARY_DIR}/test-root)
file(MAKE_DIRECTORY ${PALPATE_TEST_ROOT})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/tests ${PALPATE_TEST_ROOT}/tests SYMBOLIC)

# The program `target` from `SOURCES`.
function(palpate_test_program target)
  cmake_parse_arguments(TEST "GPU;FAST" "" "SOURCES;DEPENDS;LIBRARIES;USES;LABELS" ${ARGN})
  set(fast "")
  if(TEST_FAST)
    set(fast FAST_)
  endif()
  string(TOLOWER "palpate_${fast}test_pch" pch)
  add_executable(${target} ${TEST_SOURCES})
  set_target_properties(${target} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/test-bin)
  target_compile_options(${target} PRIVATE ${PALPATE_${fast}TEST_OPTIONS})
  target_precompile_headers(${target} REUSE_FROM ${pch})
  target_include_directories(${target} PRIVATE ${CMAKE_CURRENT_SOURCE_DIR} ${PALPATE_TEST_ROOT})
  palpate_all_rooms(rooms ${TEST_DEPENDS})
  palpate_use_rooms(${target} ${rooms})
  target_link_libraries(${target} PRIVATE palpate_compiler Eigen3::Eigen fmt::fmt ${TEST_LIBRARIES} GTest::gmock)
  if(TEST_GPU)
    target_link_libraries(${target} PRIVATE palpate_gpu_test_main)
  else()
    target_link_libraries(${target} PRIVATE palpate_test_main)
  endif()
  palpate_fence(${target} ${TEST_USES})
  foreach(label IN LISTS TEST_LABELS)
    if(label MATCHES "^short-")
      add_dependencies(${label} ${target})
    endif()
  endforeach()
endfunction()

function(palpate_test name)
  cmake_parse_arguments(TEST "GPU;FAST" "" "SOURCES;DEPENDS;LIBRARIES;USES;LABELS" ${ARGN})
  palpate_test_program(test_${name} ${ARGN})
  if(TEST_GPU)
    list(APPEND TEST_LABELS gpu)
  endif()
  add_test(NAME ${name} COMMAND test_${name})
  set_tests_properties(${name} PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT ${PALPATE_TEST_TIMEOUT})
endfunction()

# PROGRAM: the target's name without "test_", where it is not the room's; APART: files that are compiled alone.
function(palpate_tests room)
  cmake_parse_arguments(TEST "GPU;FAST" "PROGRAM" "TESTS;SOURCES;APART;DEPENDS;LIBRARIES;USES;LABELS" ${ARGN})
  if(NOT TEST_PROGRAM)
    set(TEST_PROGRAM ${room})
  endif()
  set(sources ${TEST_TESTS})
  list(TRANSFORM sources APPEND _test.cpp)
  if(PALPATE_JOIN)
    set(PALPATE_JOIN_COUNT 16)  # tests share more headers than the files of a room do
    palpate_join(test_${TEST_PROGRAM} sources SOURCES ${sources} APART ${TEST_APART})
  endif()
  set(flags "")
  foreach(flag GPU FAST)
    if(TEST_${flag})
      list(APPEND flags ${flag})
    endif()
  endforeach()
  palpate_test_program(test_${TEST_PROGRAM} ${flags} SOURCES ${sources} ${TEST_SOURCES} DEPENDS ${TEST_DEPENDS}
    LIBRARIES ${TEST_LIBRARIES} USES ${TEST_USES} LABELS ${TEST_LABELS})
  if(TEST_GPU)
    list(APPEND TEST_LABELS gpu)
  endif()
  foreach(test IN LISTS TEST_TESTS)
    add_test(NAME ${room}_${test} COMMAND test_${TEST_PROGRAM} --only ${test}_test.cpp)
    set_tests_properties(${room}_${test} PROPERTIES LABELS "${TEST_LABELS}" TIMEOUT ${PALPATE_TEST_TIMEOUT})
  endforeach()
endfunction()
