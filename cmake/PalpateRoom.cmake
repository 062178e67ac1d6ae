# One library target per room of the house, so that a forbidden dependency does not build.
#
#   palpate_room(servo_window SOURCES x.cpp DEPENDS base LIBRARIES Eigen3::Eigen USES Vulkan)
#
# Two fences make the folder rule real:
#  - A room sees only its own headers and those of the rooms it DEPENDS on: each room's include root holds one link,
#    to that room's folder.
#  - Headers of Vulkan, OpenVDB, ITK, Embree and Assimp lie in /usr/include, where every compiler run finds them. A room that does not
#    say USES gets, in front of them, headers of the same name that only stop the build.

set(PALPATE_FENCED Vulkan OpenVDB ITK Embree Assimp)
set(PALPATE_FENCED_Vulkan /usr/include/vulkan)
set(PALPATE_FENCED_OpenVDB /usr/include/openvdb)
set(PALPATE_FENCED_ITK /usr/include/ITK-5.2)
set(PALPATE_FENCED_Embree /usr/include/embree3)
set(PALPATE_FENCED_Assimp /usr/include/assimp)

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

# Adds to `target` the fences of every library that it does not use.
function(palpate_fence target)
  foreach(library IN LISTS PALPATE_FENCED)
    if(NOT library IN_LIST ARGN)
      target_include_directories(${target} BEFORE PRIVATE ${CMAKE_BINARY_DIR}/fences/${library})
    endif()
  endforeach()
endfunction()

function(palpate_room name)
  cmake_parse_arguments(ROOM "" "" "SOURCES;DEPENDS;LIBRARIES;PRIVATE_LIBRARIES;USES" ${ARGN})
  file(RELATIVE_PATH folder ${PROJECT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR})
  set(include_root ${CMAKE_BINARY_DIR}/rooms/${name})
  get_filename_component(parent ${include_root}/${folder} DIRECTORY)
  file(MAKE_DIRECTORY ${parent})
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${include_root}/${folder} SYMBOLIC)

  set(target palpate_${name})
  if(ROOM_SOURCES)
    add_library(${target} STATIC ${ROOM_SOURCES})
    target_link_libraries(${target} PRIVATE palpate_compiler ${ROOM_PRIVATE_LIBRARIES})
    target_include_directories(${target} PUBLIC ${include_root})
    palpate_fence(${target} ${ROOM_USES})
    set(reach PUBLIC)
  else()
    add_library(${target} INTERFACE)
    target_include_directories(${target} INTERFACE ${include_root})
    set(reach INTERFACE)
  endif()
  list(TRANSFORM ROOM_DEPENDS PREPEND palpate::)
  target_link_libraries(${target} ${reach} ${ROOM_DEPENDS} ${ROOM_LIBRARIES})
  add_library(palpate::${name} ALIAS ${target})
endfunction()
