# Renders a picture and compares it with the one that is kept. Set INKTRACE_KEEP_PICTURES in the
# environment to keep the new one instead, and look at it before you commit it.
separate_arguments(ARGS)
execute_process(COMMAND ${BINARY} render ${INPUT} ${ARGS} --quiet -o ${ACTUAL} RESULT_VARIABLE status)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "rendering failed")
endif()
if(DEFINED ENV{INKTRACE_KEEP_PICTURES})
    file(COPY_FILE ${ACTUAL} ${EXPECTED})
endif()
execute_process(COMMAND ${COMPARE} ${EXPECTED} ${ACTUAL} ${ACTUAL}.difference.png
    RESULT_VARIABLE status)
if(NOT status EQUAL 0)
    message(FATAL_ERROR "${ACTUAL} is not ${EXPECTED}")
endif()
