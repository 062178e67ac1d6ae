# The servo as one library, where it is not a part of the whole house: its rooms add their sources to palpate_servo.
include(${CMAKE_CURRENT_SOURCE_DIR}/../cmake/PalpateCompiler.cmake)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(Threads REQUIRED)

# What the servo uses of base/; the rest of base/ needs more than Eigen.
set(base ${CMAKE_CURRENT_SOURCE_DIR}/../base)
add_library(palpate_servo STATIC ${base}/crc32c.cpp ${base}/error.cpp ${base}/formatted.cpp ${base}/lattice.cpp ${base}/nearest_word.cpp ${base}/quantile.cpp ${base}/thread_names.cpp)
add_library(palpate::servo ALIAS palpate_servo)
target_include_directories(palpate_servo PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/..)
target_compile_features(palpate_servo PUBLIC cxx_std_20)
target_link_libraries(palpate_servo PUBLIC Eigen3::Eigen Threads::Threads PRIVATE $<BUILD_INTERFACE:palpate_compiler>)
set_target_properties(palpate_servo PROPERTIES UNITY_BUILD_MODE GROUP)  # for -DCMAKE_UNITY_BUILD=ON: a file for each room

# The same lists of sources as in the whole house (cmake/PalpateRoom.cmake).
function(palpate_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;DEPENDS;LIBRARIES" ${ARGN})
  list(TRANSFORM ROOM_SOURCES PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  target_sources(palpate_servo PRIVATE ${ROOM_SOURCES})
  set_source_files_properties(${ROOM_SOURCES} TARGET_DIRECTORY palpate_servo PROPERTIES UNITY_GROUP ${name})
endfunction()

if(PROJECT_IS_TOP_LEVEL)
  enable_testing()
  add_subdirectory(example)
endif()
