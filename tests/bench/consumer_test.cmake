# Installs vpm, builds examples/consumer against the installation, and runs it and the installed executables. Run by ctest
# with -DBUILD=, -DGENERATOR=, -DSOURCE=, -DWORK=. It takes the build's generator: CMake's default needs make, which need not
# be installed.
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
# From a mesh and a depth image to an answer: half of the cube is behind the wall.
set(inputs ${SOURCE}/tests/tools/inputs)
run(${WORK}/build/mesh-to-answer ${inputs}/cube.off ${inputs}/wall.png 60,60,31.5,23.5 0,0,1,0,0,0,1)
if(NOT output MATCHES "^volume 0\\.00[34][0-9]* m.3 .(49|50)")
  message(FATAL_ERROR "unexpected answer: ${output}")
endif()
# It prints what is doubted, with the cure: here a mesh that is scaled wrongly.
run(${WORK}/build/mesh-to-answer ${inputs}/cube.off ${inputs}/wall.png 60,60,31.5,23.5 0,0,1,0,0,0,1 1000)
if(NOT output MATCHES "warning: the tool is 346 m across and the scene [0-9.]* m: if the mesh is in millimetres, give `scale` 0.001")
  message(FATAL_ERROR "unexpected answer: ${output}")
endif()
# A haptic loop pushes back.
run(${WORK}/build/control-loop ${SOURCE}/formats/golden/v1/cube.vpmg)
if(NOT output MATCHES "at most [0-9.]*[1-9][0-9.]* % of the tool inside, [0-9.]*[1-9][0-9.]* N felt")
  message(FATAL_ERROR "unexpected answer: ${output}")
endif()
# What is installed besides the libraries, the executables and CMake's package files are the public headers.
file(GLOB_RECURSE headers RELATIVE ${WORK}/prefix/include ${WORK}/prefix/include/*)
file(GLOB public RELATIVE ${SOURCE}/libvpm/include ${SOURCE}/libvpm/include/vpm/*)
if(NOT headers STREQUAL public)
  message(FATAL_ERROR "installed headers: ${headers}")
endif()
# The installed executables find what they need.
set(bin ${WORK}/prefix/bin)
run(${bin}/vpm-pack ${inputs}/cube.off -o ${WORK}/cube.vpmp --spheres 50 --quiet)
run(${bin}/vpm-graph ${WORK}/cube.vpmp -o ${WORK}/cube.vpmg --quiet)
run(${bin}/vpm-normals ${inputs}/wall.png -o ${WORK}/wall.vpmc --intrinsics 60,60,31.5,23.5 --quiet)
run(${bin}/vpm-query --tool ${WORK}/cube.vpmg --cloud ${WORK}/wall.vpmc --pose 0,0,1,0,0,0,1)
if(NOT output MATCHES "\"volume_fraction\": *0\\.(49|5)")
  message(FATAL_ERROR "unexpected answer: ${output}")
endif()
