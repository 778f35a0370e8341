# meristem_folders(RESULT ROOT): the folders below ROOT that hold .cpp files, as paths from ROOT.
function(meristem_folders result root)
  file(GLOB_RECURSE folders CONFIGURE_DEPENDS RELATIVE ${root} ${root}/*/*.cpp)
  list(TRANSFORM folders REPLACE "/[^/]+$" "")
  list(REMOVE_DUPLICATES folders)
  set(${result} ${folders} PARENT_SCOPE)
endfunction()

# meristem_layer(NAME ABOVE layer USES x y ... MODULES folder ...): the library meristem_NAME from the folders of NAME/,
# upon the library of the layer below and other people's libraries. Each folder is an object library (meristem_NAME_a,
# meristem_NAME_b_c) that knows the headers below it but not our libraries, so that it builds alone. New files and
# folders are picked up by the next build. The folders of MODULES are left to meristem_module.
function(meristem_layer layer)
  cmake_parse_arguments(ARG "" "ABOVE" "USES;MODULES" ${ARGN})
  add_library(meristem_${layer}_uses INTERFACE)
  target_link_libraries(meristem_${layer}_uses INTERFACE meristem_flags ${ARG_USES})
  file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/${layer}_layer.cpp CONTENT "// See the object libraries.\n")
  add_library(meristem_${layer} STATIC ${CMAKE_BINARY_DIR}/generated/${layer}_layer.cpp)
  target_link_libraries(meristem_${layer} PUBLIC meristem_${layer}_uses)
  if(ARG_ABOVE)
    target_link_libraries(meristem_${layer}_uses INTERFACE meristem_${ARG_ABOVE}_uses)
    target_link_libraries(meristem_${layer} PUBLIC meristem_${ARG_ABOVE})
  endif()
  meristem_folders(folders ${CMAKE_SOURCE_DIR}/${layer})
  list(REMOVE_ITEM folders "" ${ARG_MODULES})
  foreach(folder ${folders})
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${layer}/${folder}/*.cpp)
    string(MAKE_C_IDENTIFIER meristem_${layer}_${folder} target)
    add_library(${target} OBJECT ${sources})
    target_link_libraries(${target} PRIVATE meristem_${layer}_uses)
    target_sources(meristem_${layer} PRIVATE $<TARGET_OBJECTS:${target}>)
  endforeach()
endfunction()

# meristem_module(NAME FOLDER folder USES x y ...): meristem_NAME.so from the sources of a folder, beside the program.
function(meristem_module name)
  cmake_parse_arguments(ARG "" "FOLDER" "USES" ${ARGN})
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/${ARG_FOLDER}/*.cpp)
  add_library(meristem_${name} MODULE ${sources})
  target_link_libraries(meristem_${name} PRIVATE meristem_flags ${ARG_USES})
  set_target_properties(meristem_${name} PROPERTIES PREFIX "" LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})
endfunction()

# meristem_tests(LAYER): for each folder of tests/LAYER the program test_LAYER_FOLDER, linked with the library of that
# layer and nothing above it. Every GoogleTest case is one ctest case, LAYER/FOLDER/Suite.Case.
include(GoogleTest)
function(meristem_tests layer)
  meristem_folders(folders ${CMAKE_SOURCE_DIR}/tests/${layer})
  foreach(folder ${folders})
    file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/${layer}/${folder}/*.cpp)
    string(MAKE_C_IDENTIFIER test_${layer}_${folder} target)
    add_executable(${target} ${sources})
    target_link_libraries(${target} PRIVATE meristem_${layer} GTest::gtest_main)
    # A test spends its time in the libraries: -O1 takes 5.9 s where -O3 takes 9.2 (grow_step_test.cpp).
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-O1>)
    target_compile_definitions(${target} PRIVATE
      MERISTEM_SOURCE_DIR="${CMAKE_SOURCE_DIR}" MERISTEM_BINARY_DIR="${CMAKE_BINARY_DIR}")
    gtest_discover_tests(${target} TEST_PREFIX ${layer}/${folder}/ DISCOVERY_TIMEOUT 60 NO_PRETTY_VALUES
      PROPERTIES LABELS ${layer} TIMEOUT 120)
  endforeach()
endfunction()

# meristem_check(NAME COMMAND ...): the ctest case checks/NAME, which passes when the command does.
function(meristem_check name)
  add_test(NAME checks/${name} ${ARGN} WORKING_DIRECTORY ${CMAKE_SOURCE_DIR})
  set_tests_properties(checks/${name} PROPERTIES LABELS checks TIMEOUT 600)
endfunction()

# meristem_benches(): the program bench_NAME from each tests/bench/NAME_bench.cpp. They are built with everything else,
# so that they stay in step with the code, and run by `./dev bench`.
function(meristem_benches)
  find_package(benchmark REQUIRED)
  file(GLOB sources CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/tests/bench/*_bench.cpp)
  foreach(source ${sources})
    get_filename_component(name ${source} NAME_WE)
    string(REGEX REPLACE "_bench$" "" name ${name})
    add_executable(bench_${name} ${source})
    target_link_libraries(bench_${name} PRIVATE meristem_renderer benchmark::benchmark_main)
    set_target_properties(bench_${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/tests/bench)
  endforeach()
endfunction()
