# Installs vpm, builds examples/consumer against the installation, and asks one query of the golden
# files. Run by ctest with -DBUILD=, -DGENERATOR=, -DSOURCE=, -DWORK=. It takes the build's generator: CMake's
# default needs make, which need not be installed.
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${WORK})
run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/examples/consumer -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix)
run(${CMAKE_COMMAND} --build ${WORK}/build)
run(${WORK}/build/consumer ${SOURCE}/formats/golden/v1/cube.vpmg
  ${SOURCE}/formats/golden/v1/wall.vpmc 0,0,0,0,0,0,1)
if(NOT output MATCHES "^volume [0-9]")
  message(FATAL_ERROR "unexpected answer: ${output}")
endif()
