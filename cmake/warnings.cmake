# The flags of all our code. No contraction: a*b+c must give the same bits wherever two cells meet
# (docs/architecture.md).
add_library(meristem_flags INTERFACE)
target_compile_features(meristem_flags INTERFACE cxx_std_20)
target_compile_options(meristem_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
  -Wno-restrict  # false alarms in GCC 12's own string concatenation: GCC bug 105651
  -ffp-contract=off -fno-math-errno -fno-trapping-math -march=x86-64-v2
  -fmacro-prefix-map=${CMAKE_SOURCE_DIR}/=)  # CHECK says geometry/mesh/mesh.cpp:12, wherever the tree lies
# A program loads only the libraries it calls: each costs the dynamic linker time at every start.
target_link_options(meristem_flags INTERFACE -Wl,--as-needed)
target_include_directories(meristem_flags INTERFACE ${CMAKE_SOURCE_DIR} ${CMAKE_BINARY_DIR}/generated)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release)
endif()

# CHECK() stays on in every build; these are the standard library's own.
option(MERISTEM_ASSERTIONS "Check indices and iterators of the standard library" OFF)
if(MERISTEM_ASSERTIONS)
  target_compile_definitions(meristem_flags INTERFACE _GLIBCXX_ASSERTIONS)
endif()

# With thread, MERISTEM_TSAN is defined: Debian's TBB is not instrumented, so geometry/base/parallel.cpp then runs its
# own loops on std::thread. GCC's flow analysis sees ghosts in instrumented code, hence the exceptions.
set(MERISTEM_SANITIZE "" CACHE STRING "Sanitizers: address,undefined or thread")
if(MERISTEM_SANITIZE)
  target_compile_options(meristem_flags INTERFACE -fsanitize=${MERISTEM_SANITIZE} -fno-omit-frame-pointer -g
    -fno-sanitize-recover=all -Wno-error=maybe-uninitialized -Wno-error=stringop-overflow -Wno-error=array-bounds)
  target_link_options(meristem_flags INTERFACE -fsanitize=${MERISTEM_SANITIZE})
  if(MERISTEM_SANITIZE MATCHES "thread")
    target_compile_definitions(meristem_flags INTERFACE MERISTEM_TSAN)
  endif()
endif()
