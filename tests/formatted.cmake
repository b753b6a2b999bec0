# SPDX-License-Identifier: BSD-3-Clause
# Every source of ours is as .clang-format lays it out; other versions of clang-format lay out otherwise.
foreach(folder include src tools tests examples bench python packaging)
  foreach(kind hpp cuh cpp cu)
    file(GLOB_RECURSE some ${ROOT}/${folder}/*.${kind})
    list(APPEND sources ${some})
  endforeach()
endforeach()
list(JOIN sources "\n" names)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/formatted.txt "${names}\n")
execute_process(COMMAND ${CLANG_FORMAT} --dry-run --Werror --files=${CMAKE_CURRENT_BINARY_DIR}/formatted.txt
                RESULT_VARIABLE failed)
if(failed)
  message(FATAL_ERROR "clang-format-19 -i lays these out")
endif()
