# SPDX-License-Identifier: BSD-3-Clause
# Settings for our own tests, examples, benchmarks and the command; nothing here affects a consumer.

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Debug, Release, RelWithDebInfo or MinSizeRel" FORCE)
  endif()
  find_program(CLEARANCE_CCACHE ccache)
  mark_as_advanced(CLEARANCE_CCACHE)
  if(CLEARANCE_CCACHE)
    foreach(language CXX CUDA)
      if(NOT DEFINED CMAKE_${language}_COMPILER_LAUNCHER)
        set(CMAKE_${language}_COMPILER_LAUNCHER ${CLEARANCE_CCACHE})
      endif()
    endforeach()
  endif()
endif()
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# CLEARANCE_HAS_CUDA: build our CUDA programs. The default is one architecture, because "native" is an error on a
# machine without a GPU, as in CI; where programs for the GPU are only checked, as far as PTX.
set(CLEARANCE_HAS_CUDA OFF)
if(NOT CLEARANCE_CUDA STREQUAL "OFF")
  include(CheckLanguage)
  check_language(CUDA)
  if(CMAKE_CUDA_COMPILER)
    if(NOT DEFINED CMAKE_CUDA_ARCHITECTURES)
      set(architectures 90)
      if(CLEARANCE_DEVICE_PROGRAMS STREQUAL "CHECK")
        set(architectures 90-virtual)
      endif()
      set(CMAKE_CUDA_ARCHITECTURES ${architectures} CACHE STRING "GPU architectures of our own programs")
    endif()
    enable_language(CUDA)
    set(CLEARANCE_HAS_CUDA ON)
  elseif(CLEARANCE_CUDA STREQUAL "AUTO")
    message(STATUS "clearance: no CUDA compiler, so no programs for the GPU")
  else()
    message(FATAL_ERROR "CLEARANCE_CUDA is ${CLEARANCE_CUDA}, but there is no CUDA compiler (set CUDACXX to nvcc)")
  endif()
endif()

# clearance_own: warnings and sanitizers, linked by all of our programs.
add_library(clearance_own INTERFACE)
target_link_libraries(clearance_own INTERFACE clearance::clearance)
target_compile_options(clearance_own INTERFACE
  $<$<COMPILE_LANGUAGE:CXX>:-Wall -Wextra -Wpedantic>
  $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=-Wall,-Wextra>)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  # False alarms of GCC 12 in its own std::string and in Eigen.
  target_compile_options(clearance_own INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Wno-restrict -Wno-maybe-uninitialized>
    $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xcompiler=-Wno-restrict,-Wno-maybe-uninitialized>)
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "Clang" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 17)
  # A false alarm of newer clang in the std::stable_sort of an older libstdc++.
  target_compile_options(clearance_own INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-Wno-deprecated-declarations>)
endif()
# The recursive traversal recurses; its programs say how much stack it needs.
target_compile_options(clearance_own INTERFACE $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Xptxas=--suppress-stack-size-warning>)
if(CLEARANCE_WARNINGS_AS_ERRORS)
  target_compile_options(clearance_own INTERFACE
    $<$<COMPILE_LANGUAGE:CXX>:-Werror> $<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:-Werror=all-warnings -Xcompiler=-Werror>)
endif()
if(CLEARANCE_SANITIZE)
  # Checks of every access for null and object size only find what the address sanitizer finds. The alignment check is only
  # for programs that read bytes at any address (CLEARANCE_READS_BYTES). Together they would double the compile time.
  target_compile_options(clearance_own INTERFACE $<$<COMPILE_LANGUAGE:CXX>:-fsanitize=address,undefined
                         -fno-sanitize=null,object-size,vptr -fno-sanitize-recover=undefined -fno-omit-frame-pointer
                         $<$<NOT:$<BOOL:$<TARGET_PROPERTY:CLEARANCE_READS_BYTES>>>:-fno-sanitize=alignment>>)
  target_link_options(clearance_own INTERFACE -fsanitize=address,undefined)
  target_compile_definitions(clearance_own INTERFACE CLEARANCE_SANITIZED)  # not every compiler has a word of its own
endif()

# clearance_compile_faster(language): from here on in this folder, a release is -O1 on the host. For CUDA that halves
# the compile time of tests. GPU code stays optimised, because nvcc's -O is for the host only.
macro(clearance_compile_faster language)
  string(REPLACE "-O3" "-O1" CMAKE_${language}_FLAGS_RELEASE "${CMAKE_${language}_FLAGS_RELEASE}")
endmacro()

# clearance_compile_once(target): walks for processors with wide vectors alone, where this one has them, not also for those
# without (with_vectors). That takes half the time of most, a fifth of some.
option(CLEARANCE_THIS_PROCESSOR "Compile our programs for processors like this one alone, in half the time" OFF)
set(clearance_wide_vectors)
string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
set(clearance_build_flags "${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}")
if(CLEARANCE_THIS_PROCESSOR AND EXISTS /proc/cpuinfo AND NOT CMAKE_CROSSCOMPILING
   AND NOT clearance_build_flags MATCHES "-m(avx2|arch)")  # which also libraries have
  file(STRINGS /proc/cpuinfo flags REGEX "^flags.* avx2( |$)" LIMIT_COUNT 1)
  if("${flags} " MATCHES " fma ")
    # Spheres are packed as without these flags, because no sum is contracted. Eigen aligns and allocates as in what is
    # linked (same_eigen.hpp); so it must not multiply large matrices, whose blocks it would take to be aligned for AVX.
    set(clearance_wide_vectors -mavx2 -mfma -ffp-contract=off -DEIGEN_MAX_ALIGN_BYTES=16 -DEIGEN_MALLOC_ALREADY_ALIGNED=1)
  endif()
endif()
function(clearance_compile_once target)
  target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang>:${clearance_wide_vectors}>)
  if(clearance_wide_vectors)
    # Below -O2, g++ leaves the upper halves of registers in use, and what is linked, without AVX, runs at a tenth of its speed.
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fexpensive-optimizations>)
  endif()
endfunction()

# The GPU check, linked into device programs that CTest runs: exit code 77 ("skipped") without a GPU.
if(CLEARANCE_HAS_CUDA AND CLEARANCE_BUILD_TESTS)
  add_library(clearance_require_device OBJECT ${PROJECT_SOURCE_DIR}/tests/support/require_device.cu)
  target_link_libraries(clearance_require_device PRIVATE clearance_own)
endif()

# Real robots and depth frames, for tests and benchmarks: CLEARANCE_TEST_DATA in their code.
set(CLEARANCE_DATA "" CACHE STRING "Folder of real robots and depth frames; by default ../shared/data")
set(clearance_data ${CLEARANCE_DATA})
set(clearance_have_data ON)
if(NOT clearance_data)
  set(clearance_data ${PROJECT_SOURCE_DIR}/../shared/data)
  cmake_path(NORMAL_PATH clearance_data)
endif()
if(IS_ABSOLUTE ${clearance_data} AND NOT EXISTS ${clearance_data})  # a relative one is for a copy that runs elsewhere
  set(clearance_have_data OFF)
  message(STATUS "clearance: tests of real data are skipped (no folder ${clearance_data})")
endif()

# clearance_device_programs: build programs that need a GPU, and let CTest run them.
set(clearance_device_programs OFF)
if(CLEARANCE_DEVICE_PROGRAMS AND NOT CLEARANCE_DEVICE_PROGRAMS STREQUAL "CHECK")
  set(clearance_device_programs ON)
endif()

# clearance_together(units name sources... [RENAME words...] [MAINS]): replaces sources by units, each including some sources
# of one language, so that shared headers are parsed and instantiated once. So two sources of a program must not define the
# same name in one namespace. Words get each source's number, from 1; with MAINS tests/support/programs.cpp runs the main of
# that number.
set(CLEARANCE_TOGETHER 10 CACHE STRING "How many sources of a program are compiled together, at most; 1: each alone")
function(clearance_together units name)
  cmake_parse_arguments(P "MAINS" "" "RENAME" ${ARGN})
  set(made)
  foreach(language cpp cu)
    set(those ${P_UNPARSED_ARGUMENTS})
    list(FILTER those INCLUDE REGEX "[.]${language}$")
    list(LENGTH those count)
    if(count LESS 2 OR CLEARANCE_TOGETHER LESS 2)
      list(APPEND made ${those})
      continue()
    endif()
    math(EXPR pieces "(${count} + ${CLEARANCE_TOGETHER} - 1) / ${CLEARANCE_TOGETHER}")
    if(count GREATER 3)  # an even number: often there are two cores
      math(EXPR pieces "(${pieces} + 1) / 2 * 2")
    endif()
    set(number 0)
    foreach(piece RANGE 1 ${pieces})
      set(text)
      if(P_MAINS)
        set(programs ${PROJECT_SOURCE_DIR}/tests/support/programs.hpp)
        cmake_path(RELATIVE_PATH programs BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/together)
        set(text "#include \"${programs}\"\n")
      endif()
      math(EXPR last "${count} * ${piece} / ${pieces}")
      while(number LESS last)
        list(GET those ${number} source)
        cmake_path(ABSOLUTE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR} NORMALIZE)
        math(EXPR number "${number} + 1")
        foreach(word ${P_RENAME})
          string(APPEND text "#define ${word} ${word}_${number}\n")
        endforeach()
        cmake_path(RELATIVE_PATH source BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/together)  # as ccache knows it elsewhere, too
        string(APPEND text "#include \"${source}\"\n")
        foreach(word ${P_RENAME})
          string(APPEND text "#undef ${word}\n")
        endforeach()
        if(P_MAINS)
          string(APPEND text "static const testing::program program_${number}(${number}, main_${number});\n")
        endif()
      endwhile()
      set(unit ${CMAKE_CURRENT_BINARY_DIR}/together/${name}_${piece}.${language})
      file(CONFIGURE OUTPUT ${unit} CONTENT "${text}" @ONLY)
      list(APPEND made ${unit})
    endforeach()
  endforeach()
  set(${units} ${made} PARENT_SCOPE)
endfunction()

# clearance_checked(name [RENAME words...]): compiles the CUDA sources of this folder's GPU programs, which are not
# built, as far as PTX. That pass also reads the host's code, and instantiates every template that it calls; it only
# leaves out optimisation, the assembler and the link.
function(clearance_checked name)
  get_property(programs DIRECTORY PROPERTY clearance_checked_programs)
  get_property(sources DIRECTORY PROPERTY clearance_checked_sources)
  if(NOT sources)
    return()
  endif()
  clearance_together(units ${name}_checked ${sources} ${ARGN})
  add_library(${name}_checked OBJECT ${units})
  foreach(program ${programs})
    target_link_libraries(${name}_checked PRIVATE $<TARGET_PROPERTY:${program},LINK_LIBRARIES>)
    target_include_directories(${name}_checked PRIVATE $<TARGET_PROPERTY:${program},INCLUDE_DIRECTORIES>)
    target_compile_definitions(${name}_checked PRIVATE $<TARGET_PROPERTY:${program},COMPILE_DEFINITIONS>)
  endforeach()
  target_compile_options(${name}_checked PRIVATE ${clearance_fast_device_code})
  set_target_properties(${name}_checked PROPERTIES CUDA_PTX_COMPILATION ON)
endfunction()
if(CLEARANCE_HAS_CUDA AND CLEARANCE_DEVICE_PROGRAMS STREQUAL "CHECK")
  include(CheckCompilerFlag)
  check_compiler_flag(CUDA -Ofc=max CLEARANCE_NVCC_FAST)  # not every nvcc has it
  if(CLEARANCE_NVCC_FAST)
    set(clearance_fast_device_code -Ofc=max)
  endif()
endif()

set(clearance_timeout 600)  # seconds a test may take
if(CMAKE_CROSSCOMPILING)
  set(clearance_timeout 7200)  # it is emulated
endif()

# clearance_program(NAME name SOURCES files... [DEVICE] [TEST] [GPU_RUN kind] [ARGUMENTS args...] [LIBRARIES targets...])
# One program. DEVICE: needs a GPU to run; TEST: CTest runs it; GPU_RUN: scripts/gpu-test runs it as this kind.
function(clearance_program)
  cmake_parse_arguments(P "DEVICE;TEST" "NAME;GPU_RUN" "SOURCES;ARGUMENTS;LIBRARIES" ${ARGN})
  clearance_together(units ${P_NAME} ${P_SOURCES})
  add_executable(${P_NAME} ${units})
  target_link_libraries(${P_NAME} PRIVATE clearance_own ${P_LIBRARIES} clearance_solid)
  if(P_GPU_RUN)
    clearance_gpu_run(${P_GPU_RUN} ${P_NAME})
  endif()
  if(P_DEVICE AND NOT clearance_device_programs)
    set_target_properties(${P_NAME} PROPERTIES EXCLUDE_FROM_ALL ON)
    if(CLEARANCE_DEVICE_PROGRAMS STREQUAL "CHECK")
      set_property(DIRECTORY APPEND PROPERTY clearance_checked_programs ${P_NAME})
      set_property(DIRECTORY APPEND PROPERTY clearance_checked_sources ${P_SOURCES})
    endif()
    return()
  endif()
  if(P_TEST AND CLEARANCE_BUILD_TESTS)
    add_test(NAME ${P_NAME} COMMAND ${P_NAME} ${P_ARGUMENTS})
    set_tests_properties(${P_NAME} PROPERTIES TIMEOUT ${clearance_timeout})
    if(P_DEVICE)
      target_link_libraries(${P_NAME} PRIVATE clearance_require_device)
      set_tests_properties(${P_NAME} PROPERTIES SKIP_RETURN_CODE 77 LABELS device)
    endif()
  endif()
endfunction()

# clearance_lacks(part packages...): part of TESTS, EXAMPLES, BENCH or TOOLS is left out because these Debian packages
# are missing. clearance_say_what_is_missing(): one line per part, or an error if the part was asked for.
function(clearance_lacks part)
  set_property(GLOBAL APPEND PROPERTY clearance_lacks_${part} ${ARGN})
endfunction()
function(clearance_say_what_is_missing)
  set(names_TESTS "the tests")
  set(names_EXAMPLES "the examples")
  set(names_BENCH "the benchmarks")
  set(names_TOOLS "the command")
  set(yardsticks libembree-dev libopenvdb-dev libboost-dev)  # what only a comparison with others needs is never an error
  foreach(part TOOLS EXAMPLES BENCH TESTS)
    get_property(lacks GLOBAL PROPERTY clearance_lacks_${part})
    list(REMOVE_DUPLICATES lacks)
    if("CLEARANCE_BUILD_IO=ON" IN_LIST lacks)
      list(REMOVE_ITEM lacks "CLEARANCE_BUILD_IO=ON")
      if(NOT CLEARANCE_BUILD_${part} STREQUAL "AUTO")
        message(FATAL_ERROR "CLEARANCE_BUILD_${part} is ${CLEARANCE_BUILD_${part}}, but all of ${names_${part}} need the component "
                            "io, and CLEARANCE_BUILD_IO is ${CLEARANCE_BUILD_IO}")
      endif()
      message(STATUS "clearance: what of ${names_${part}} needs the component io is left out, because CLEARANCE_BUILD_IO is "
                     "${CLEARANCE_BUILD_IO}")
    endif()
    set(errors ${lacks})
    list(REMOVE_ITEM errors ${yardsticks})
    list(JOIN lacks " " lacks)
    list(JOIN errors " " errors)
    if(errors AND NOT CLEARANCE_BUILD_${part} STREQUAL "AUTO")
      message(FATAL_ERROR "CLEARANCE_BUILD_${part} is ${CLEARANCE_BUILD_${part}}, but for all of ${names_${part}} these Debian "
                          "packages are missing: ${errors}")
    elseif(lacks)
      message(STATUS "clearance: what of ${names_${part}} needs these Debian packages is left out: ${lacks}")
    endif()
  endforeach()
endfunction()

# clearance_needs(part sources libraries complete): what the sources need besides the library, judging by their
# includes, and whether all of it is here; if not, calls clearance_lacks for the part.
find_package(fcl CONFIG QUIET)
find_package(embree 3 CONFIG QUIET)
find_package(nlohmann_json CONFIG QUIET)
find_package(MPI QUIET COMPONENTS CXX)
if(MPI_CXX_FOUND)  # CMake makes MPI::MPI_CXX in any case
  add_library(clearance_mpi INTERFACE)
  target_link_libraries(clearance_mpi INTERFACE MPI::MPI_CXX)
endif()
function(clearance_needs part sources libraries complete)
  set(found)
  set(${complete} ON PARENT_SCOPE)
  get_property(command_lacks GLOBAL PROPERTY clearance_lacks_TOOLS)
  macro(clearance_need sign target)  # and Debian's packages
    foreach(source ${sources})
      file(STRINGS ${source} mentioned REGEX ${sign} LIMIT_COUNT 1)
      if(mentioned AND TARGET ${target})
        list(APPEND found ${target})
      elseif(mentioned)
        set(${complete} OFF PARENT_SCOPE)
        clearance_lacks(${part} ${ARGN})
      endif()
    endforeach()
  endmacro()
  clearance_need("<clearance/io/" clearance::io ${clearance_io_missing})
  clearance_need("<clearance/mpi/" clearance_mpi libopenmpi-dev openmpi-bin)
  clearance_need("<fcl/" fcl libfcl-dev)
  clearance_need("<embree3/" embree libembree-dev)
  clearance_need("<openvdb/" openvdb libopenvdb-dev libboost-dev)
  clearance_need("<vamp/" vamp)  # no package
  clearance_need("<nlohmann/" nlohmann_json::nlohmann_json nlohmann-json3-dev)
  clearance_need("testing::command" clearance_command ${command_lacks})
  list(REMOVE_DUPLICATES found)
  set(${libraries} "${found}" PARENT_SCOPE)
endfunction()

# What scripts/gpu-test builds (target gpu_programs) and runs (gpu-programs.txt; lines of kind, name, file).
function(clearance_gpu_run kind target)
  set_property(GLOBAL APPEND PROPERTY clearance_gpu_programs ${target})
  set_property(GLOBAL APPEND_STRING PROPERTY clearance_gpu_lines "${kind} ${target} $<TARGET_FILE:${target}>\n")
endfunction()
function(clearance_gpu_programs)
  get_property(programs GLOBAL PROPERTY clearance_gpu_programs)
  get_property(lines GLOBAL PROPERTY clearance_gpu_lines)
  if(programs)
    add_custom_target(gpu_programs DEPENDS ${programs})
    file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/gpu-programs.txt CONTENT "${lines}")
  endif()
endfunction()
