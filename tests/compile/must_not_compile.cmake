# SPDX-License-Identifier: BSD-3-Clause
# cmake -DCOMPILER= -DSOURCE= -DARGUMENTS=<response file> -DFLAGS=<list> -DWORK=<folder> -P must_not_compile.cmake
# Passes when SOURCE does not compile and the compiler says the sentence after "// expected-error: ". With a line
# "// and no other error" it must be all that g++ and clang say.

file(STRINGS ${SOURCE} expected REGEX "^// expected-error: ")
string(REPLACE "// expected-error: " "" expected "${expected}")
if(NOT expected)
  message(FATAL_ERROR "${SOURCE} has no line '// expected-error: ...'")
endif()

# Under another name and without that line, so that neither can be what is found in the output.
file(READ ${SOURCE} text)
string(FIND "${text}" "// and no other error" alone)
string(REGEX REPLACE "// expected-error: [^\n]*" "" text "${text}")
file(WRITE ${WORK}/case.cpp "${text}")

file(STRINGS ${ARGUMENTS} arguments)
execute_process(COMMAND ${COMPILER} ${FLAGS} ${arguments} ${WORK}/case.cpp
                RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(status EQUAL 0)
  message(FATAL_ERROR "${SOURCE} compiles, and must not")
endif()
string(FIND "${output}" "${expected}" found)
if(found EQUAL -1)
  message(FATAL_ERROR "${SOURCE} fails without saying\n  ${expected}\nbut\n${output}")
endif()
if(NOT alone EQUAL -1 AND NOT COMPILER MATCHES "nvcc")
  string(REGEX MATCHALL "error: " errors "${output}")
  list(LENGTH errors count)
  if(NOT count EQUAL 1)
    message(FATAL_ERROR "${SOURCE} fails with ${count} errors, not one:\n${output}")
  endif()
endif()
