# Compiler settings shared by every target, and the one way to declare a library.
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
endif()
set(CMAKE_CXX_FLAGS_RELEASE "-O3")  # without NDEBUG: a broken invariant stops the run
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/bin)

add_library(grainlaw_settings INTERFACE)
target_compile_features(grainlaw_settings INTERFACE cxx_std_20)
target_compile_options(grainlaw_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion
  # Fused multiply-add and one-instruction square roots; no other liberty is taken with arithmetic.
  -ffp-contract=fast -fno-math-errno)
if(GRAINLAW_MARCH)
  target_compile_options(grainlaw_settings INTERFACE -march=${GRAINLAW_MARCH})
endif()
if(GRAINLAW_SANITIZE)
  target_compile_options(grainlaw_settings INTERFACE
    -fsanitize=${GRAINLAW_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(grainlaw_settings INTERFACE -fsanitize=${GRAINLAW_SANITIZE})
endif()

# grainlaw_library(name sources...): a static library grainlaw_<name>, alias grainlaw::<name>.
function(grainlaw_library name)
  add_library(grainlaw_${name} STATIC ${ARGN})
  add_library(grainlaw::${name} ALIAS grainlaw_${name})
  set_target_properties(grainlaw_${name} PROPERTIES EXPORT_NAME ${name})
  target_compile_features(grainlaw_${name} PUBLIC cxx_std_20)
  target_link_libraries(grainlaw_${name} PRIVATE $<BUILD_INTERFACE:grainlaw_settings>)
  target_include_directories(grainlaw_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}/grainlaw>)
endfunction()
