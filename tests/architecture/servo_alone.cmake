# Run with -DSOURCE=<repository> -DFOLDER=<where to build> -DCOMPILER=<C++ compiler> -DEIGEN=<Eigen's folder>
# -DREADELF=<readelf>. Builds the servo as a project of its own, each file by itself, and runs its example, from a folder that
# holds servo/, base/ and cmake/ alone. It checks that CMake found no package but Eigen, that every header that was read is Palpate's, Eigen's, the compiler's or the C
# library's, and that the example is linked to the libraries of C and C++ alone.
cmake_minimum_required(VERSION 3.25)

function(run words)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE failed OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(failed)
    message(FATAL_ERROR "${ARGN}\n${out}${err}")
  endif()
  set(${words} "${out}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
file(COPY ${SOURCE}/servo ${SOURCE}/base ${SOURCE}/cmake DESTINATION ${FOLDER}/source)
set(build ${FOLDER}/build)
# Each file by itself and without precompiled headers, as in a stranger's project: so a header that a file forgot to include is
# missed here, where files joined by rooms find it through each other. Not optimised: this is about what the servo needs.
run(words ${CMAKE_COMMAND} -S ${FOLDER}/source/servo -B ${build} -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER}
    -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_FLAGS_DEBUG=-O0 -DCMAKE_UNITY_BUILD=OFF -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON)
run(words ${CMAKE_COMMAND} --build ${build} -j 2)
file(GLOB_RECURSE joined ${build}/unity_*.cxx)
if(joined)
  message(FATAL_ERROR "files are compiled together: ${joined}")
endif()
run(words ${CMAKE_CTEST_COMMAND} --test-dir ${build} --output-on-failure)
if(NOT words MATCHES "1/1 Test #1: press_ball .* Passed")
  message(FATAL_ERROR "the example did not run:\n${words}")
endif()

file(STRINGS ${build}/CMakeCache.txt packages REGEX "^[A-Za-z0-9_]+_DIR:PATH=")
list(FILTER packages EXCLUDE REGEX "^(Eigen3|palpate_servo_(BINARY|SOURCE))_DIR:")
if(packages)
  message(SEND_ERROR "CMake looked for more than Eigen: ${packages}")
endif()

run(words ninja -C ${build} -t deps)
string(REGEX MATCHALL "\n    [^\n]+" headers "${words}")
list(TRANSFORM headers STRIP)
list(REMOVE_DUPLICATES headers)
set(count 0)
foreach(header IN LISTS headers)
  get_filename_component(header ${header} ABSOLUTE BASE_DIR ${build})
  if(header MATCHES "^${FOLDER}/source/(servo|base)/")
    math(EXPR count "${count} + 1")
  elseif(NOT header MATCHES "^${build}/|/eigen3/|^/usr/include/(c\\+\\+|[a-z0-9_]+-linux-gnu)/|^/usr/include/(asm-generic|linux)/|^/usr/include/[a-z0-9_-]+\\.h$|^/usr/lib/(gcc|llvm)")
    message(SEND_ERROR "the servo reads ${header}")
  endif()
endforeach()
if(count LESS 60)
  message(SEND_ERROR "only ${count} files of the servo were read")
endif()

run(words ${READELF} -d ${build}/bin/press_ball)
string(REGEX MATCHALL "Shared library: \\[[^]]+" libraries "${words}")
foreach(library IN LISTS libraries)
  if(NOT library MATCHES "\\[(libstdc\\+\\+|libm|libgcc_s|libc|ld-linux[a-z0-9-]*)\\.so")
    message(SEND_ERROR "the example is linked to more than the libraries of C and C++: ${library}")
  endif()
endforeach()
message(STATUS "${count} files of the servo and of base; ${libraries}")
