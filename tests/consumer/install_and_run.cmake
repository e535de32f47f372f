# Installs BUILD below WORK, then configures, builds and runs the consumer against it.
file(REMOVE_RECURSE ${WORK})
set(strict COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix
                OUTPUT_QUIET ${strict})
execute_process(COMMAND ${WORK}/prefix/bin/halflight --help OUTPUT_QUIET ${strict})
execute_process(COMMAND ${CMAKE_COMMAND} -G ${GENERATOR} -S ${CMAKE_CURRENT_LIST_DIR}
                        -B ${WORK}/build -DCMAKE_PREFIX_PATH=${WORK}/prefix ${strict})
execute_process(COMMAND ${CMAKE_COMMAND} --build ${WORK}/build ${strict})
execute_process(COMMAND ${WORK}/build/consumer ${strict})
