# SPDX-License-Identifier: BSD-3-Clause
# Installs the library where that is asked for, then configures, builds and runs consumer/ as a project of its own.

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT status EQUAL 0)
    list(JOIN ARGN " " command)
    message(FATAL_ERROR "${command}\nfailed (${status}):\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
set(options -DHOW=${HOW} -DLIBRARY=${LIBRARY} -DCMAKE_CXX_COMPILER=${CXX} -DCMAKE_CXX_COMPILER_LAUNCHER=${CCACHE}
            -DFETCHCONTENT_FULLY_DISCONNECTED=ON)  # nothing may be downloaded
if(HOW STREQUAL "find_package")
  run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
  list(APPEND options -DCMAKE_PREFIX_PATH=${WORK}/prefix)
endif()
if(COMPONENT)
  list(APPEND options -DCOMPONENT=${COMPONENT})
endif()
if(WITH_CUDA)
  list(APPEND options -DWITH_CUDA=ON -DCMAKE_CUDA_COMPILER=${CUDA} -DCMAKE_CUDA_COMPILER_LAUNCHER=${CCACHE})
endif()
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${CMAKE_CURRENT_LIST_DIR}/consumer -B ${WORK}/build ${options})
run(${CMAKE_COMMAND} --build ${WORK}/build)
string(TOLOWER "${output}" lower)
if(lower MATCHES "warning")
  message(FATAL_ERROR "a user's first build is not silent:\n${output}")
endif()
run(${WORK}/build/consumer)
message(STATUS "consumer says: ${output}")

# A project in C++ alone must not be given a CUDA flag or folder.
if(NOT WITH_CUDA)
  file(READ ${WORK}/build/compile_commands.json commands)
  string(TOLOWER "${commands}" commands)
  string(REPLACE "package_" "" commands "${commands}")
  if(commands MATCHES "/cuda/|-gencode|nvcc ")
    message(FATAL_ERROR "the host-only consumer was given something of CUDA:\n${commands}")
  endif()
endif()
