# One library target per room of the house, so that a forbidden dependency does not build.
#
#   palpate_room(servo_window SOURCES x.cpp DEPENDS base LIBRARIES Eigen3::Eigen USES Vulkan)
#
# DEPENDS: the rooms whose headers this room's files include. THROUGH: rooms whose headers those headers include; no file of
# this room may include them itself. LIBRARIES come with the room's headers, PRIVATE_LIBRARIES do not.
#
# Three fences make the folder rule real:
#  - A room sees its own headers and those of the rooms that it names with DEPENDS or THROUGH, and no others. Each room's
#    include root holds one link, to that room's folder. Include paths are not passed on to other rooms; only linking is.
#  - The rooms whose headers a room's files include are exactly those of DEPENDS (tests/architecture/arrows.cmake).
#  - Headers of Vulkan, OpenVDB, ITK, Embree, Assimp and GLFW lie in /usr/include, where every compiler run finds them. A room
#    that does not say USES finds, in front of them, headers of the same names that only stop the build.

set(PALPATE_FENCED Vulkan OpenVDB ITK Embree Assimp GLFW)
set(PALPATE_FENCED_Vulkan /usr/include/vulkan)
set(PALPATE_FENCED_OpenVDB /usr/include/openvdb)
set(PALPATE_FENCED_ITK /usr/include/ITK-5.2)
set(PALPATE_FENCED_Embree /usr/include/embree3)
set(PALPATE_FENCED_Assimp /usr/include/assimp)
set(PALPATE_FENCED_GLFW /usr/include/GLFW)

foreach(library IN LISTS PALPATE_FENCED)
  set(fence ${CMAKE_BINARY_DIR}/fences/${library})
  if(NOT EXISTS ${fence}/done)
    file(GLOB_RECURSE headers RELATIVE ${PALPATE_FENCED_${library}}/.. ${PALPATE_FENCED_${library}}/*.h ${PALPATE_FENCED_${library}}/*.hpp)
    foreach(header IN LISTS headers)
      file(WRITE ${fence}/${header} "#error \"this room may not use ${library} (see its CMakeLists.txt and ARCHITECTURE.md)\"\n")
    endforeach()
    file(WRITE ${fence}/done "")
  endif()
endforeach()

# Adds to `target` the fences of all libraries but those in the other arguments.
function(palpate_fence target)
  foreach(library IN LISTS PALPATE_FENCED)
    if(NOT library IN_LIST ARGN)
      target_include_directories(${target} BEFORE PRIVATE ${CMAKE_BINARY_DIR}/fences/${library})
    endif()
  endforeach()
endfunction()

# Lets `target` see the headers of the rooms, and links them. Targets that link `target` get no headers from it. A program is
# built with the modules that its rooms load.
function(palpate_use_rooms target)
  foreach(room IN LISTS ARGN)
    target_link_libraries(${target} PRIVATE palpate_${room}_headers palpate_${room})
  endforeach()
  get_target_property(type ${target} TYPE)
  if(type STREQUAL EXECUTABLE)
    palpate_all_rooms(rooms ${ARGN})
    foreach(room IN LISTS rooms)
      get_property(loads GLOBAL PROPERTY PALPATE_LOADS_${room})
      foreach(module IN LISTS loads)
        add_dependencies(${target} palpate_module_${module})
      endforeach()
    endforeach()
  endif()
endfunction()

# Records a room and the rooms that it names, for the tests in tests/architecture.
function(palpate_note_room name folder depends through)
  set_property(GLOBAL APPEND PROPERTY PALPATE_ROOMS ${name})
  set_property(GLOBAL PROPERTY PALPATE_FOLDER_${name} ${folder})
  set_property(GLOBAL PROPERTY PALPATE_DEPENDS_${name} ${depends})
  set_property(GLOBAL PROPERTY PALPATE_THROUGH_${name} ${through})
endfunction()

# Sets `out` to the given rooms, all rooms that these name, and so on. For tests, which may look into everything.
function(palpate_all_rooms out)
  set(todo ${ARGN})
  set(all)
  while(todo)
    list(POP_FRONT todo room)
    if(room IN_LIST all)
      continue()
    endif()
    list(APPEND all ${room})
    get_property(depends GLOBAL PROPERTY PALPATE_DEPENDS_${room})
    get_property(through GLOBAL PROPERTY PALPATE_THROUGH_${room})
    list(APPEND todo ${depends} ${through})
  endwhile()
  set(${out} ${all} PARENT_SCOPE)
endfunction()

# Headers that nearly every file includes, parsed once for all rooms. They take half of the compile time of most files.
set(palpate_common_headers <Eigen/Geometry> <fmt/format.h>)
find_package(Eigen3 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/room_pch.cpp CONTENT "")
add_library(palpate_room_pch OBJECT ${CMAKE_BINARY_DIR}/room_pch.cpp)
target_link_libraries(palpate_room_pch PRIVATE palpate_compiler Eigen3::Eigen fmt::fmt)
target_precompile_headers(palpate_room_pch PRIVATE ${palpate_common_headers})

# Most of a file's compile time goes into headers. Where this is on, the files of a room are compiled a few at a time.
option(PALPATE_JOIN "compile several files of a room at once: fewer minutes for a whole build" ON)
set(PALPATE_JOIN_COUNT 16 CACHE STRING "so many files at once, with PALPATE_JOIN")

# Sets `out` to generated files that include `SOURCES` of the target, a few each, and to the files of `APART` as they are. Files
# of `TOGETHER` get a generated file to themselves: they share a library whose headers take long.
function(palpate_join name out)
  cmake_parse_arguments(JOIN "" "" "SOURCES;TOGETHER;APART" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(joined ${JOIN_APART})
  list(REMOVE_ITEM JOIN_SOURCES ${JOIN_TOGETHER} ${JOIN_APART})
  set(number 0)
  set(part ${JOIN_TOGETHER})
  while(part OR JOIN_SOURCES)
    if(NOT part)
      list(SUBLIST JOIN_SOURCES 0 ${PALPATE_JOIN_COUNT} part)
      list(REMOVE_ITEM JOIN_SOURCES ${part})
    endif()
    set(text "")
    foreach(source IN LISTS part)
      string(APPEND text "#include \"${folder}/${source}\"\n")
    endforeach()
    set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}_${number}.cpp)
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
    list(APPEND joined ${file})
    set(part "")
    math(EXPR number "${number} + 1")
  endwhile()
  set(${out} ${joined} PARENT_SCOPE)
endfunction()

# TOGETHER, APART: as in palpate_join(). GENERATED: sources that the build writes. LOADS: the modules that it calls.
# COLD: nothing in the room is time-critical, so it is optimised less, for a shorter build.
set(PALPATE_COLD $<$<CONFIG:Release>:-O1>)
function(palpate_room name)
  cmake_parse_arguments(ROOM "COLD" "" "SOURCES;TOGETHER;APART;GENERATED;DEPENDS;THROUGH;LIBRARIES;PRIVATE_LIBRARIES;USES;LOADS" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(include_root ${CMAKE_BINARY_DIR}/rooms/${name})
  get_filename_component(parent ${include_root}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include_root}/${folder} SYMBOLIC)
  palpate_note_room(${name} ${folder} "${ROOM_DEPENDS}" "${ROOM_THROUGH}")
  set_property(GLOBAL PROPERTY PALPATE_LOADS_${name} ${ROOM_LOADS})

  set(target palpate_${name})
  add_library(${target}_headers INTERFACE)
  target_include_directories(${target}_headers INTERFACE ${include_root})
  target_link_libraries(${target}_headers INTERFACE ${ROOM_LIBRARIES})
  if(PALPATE_JOIN)
    palpate_join(${name} ROOM_SOURCES SOURCES ${ROOM_SOURCES} TOGETHER ${ROOM_TOGETHER} APART ${ROOM_APART})
  endif()
  add_library(${target} STATIC ${ROOM_SOURCES} ${ROOM_GENERATED})
  target_link_libraries(${target} PRIVATE palpate_compiler Eigen3::Eigen fmt::fmt ${target}_headers ${ROOM_PRIVATE_LIBRARIES})
  palpate_use_rooms(${target} ${ROOM_DEPENDS} ${ROOM_THROUGH})
  palpate_fence(${target} ${ROOM_USES})
  target_precompile_headers(${target} REUSE_FROM palpate_room_pch)
  if(ROOM_COLD)
    target_compile_options(${target} PRIVATE ${PALPATE_COLD})
  endif()
endfunction()

# palpate_module(embree ROOM servo_meshes SOURCES embree_tree.cpp LIBRARIES embree [USES Embree])
#
# A part of a room that is loaded when it is first used (base/module.hpp): lib/palpate/embree.so. It sees what its room sees,
# holds its own copy of what it uses of the rooms, and shows its tables alone, palpate_... and the version.
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/module_version.cpp CONTENT
"extern \"C\" {
extern const char palpate_module_version[];
const char palpate_module_version[] = \"${PROJECT_VERSION}\";
}
")
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/module.symbols CONTENT "{ global: palpate_*; local: *; };\n")
function(palpate_module name)
  cmake_parse_arguments(MODULE "" "ROOM" "SOURCES;LIBRARIES;USES" ${ARGN})
  set(target palpate_module_${name})
  add_library(${target} MODULE ${MODULE_SOURCES} ${CMAKE_BINARY_DIR}/module_version.cpp)
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib/palpate)
  get_property(depends GLOBAL PROPERTY PALPATE_DEPENDS_${MODULE_ROOM})
  get_property(through GLOBAL PROPERTY PALPATE_THROUGH_${MODULE_ROOM})
  target_link_libraries(${target} PRIVATE palpate_compiler Eigen3::Eigen fmt::fmt ${MODULE_LIBRARIES})
  palpate_use_rooms(${target} ${MODULE_ROOM} ${depends} ${through})
  palpate_fence(${target} ${MODULE_USES})
  target_precompile_headers(${target} REUSE_FROM palpate_room_pch)
  target_link_options(${target} PRIVATE LINKER:--version-script=${CMAKE_BINARY_DIR}/module.symbols LINKER:--as-needed)
  if(NOT PALPATE_SANITIZE)  # the sanitizers' own symbols are in the program
    target_link_options(${target} PRIVATE LINKER:--no-undefined)
  endif()
endfunction()
