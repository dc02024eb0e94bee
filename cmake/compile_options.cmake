# Flags of every target of ours, and the helper that declares one.

add_library(inktrace_options INTERFACE)
target_compile_options(inktrace_options INTERFACE
    # Any x86-64 machine of the last fifteen years; hot loops are also built for newer ones and
    # chosen at run time (src/base/multiversion.h).
    $<$<STREQUAL:${CMAKE_SYSTEM_PROCESSOR},x86_64>:-march=x86-64-v2>
    # The same bits from every instruction set: no fused multiply-add behind our back.
    -ffp-contract=off
    # Nobody reads errno or floating-point traps; without them square roots vectorise.
    -fno-math-errno -fno-trapping-math
    -Wall -Wextra -Wpedantic -Wconversion -Wshadow
    $<$<BOOL:${INKTRACE_WERROR}>:-Werror>)
if(INKTRACE_SANITIZE)
    # Lines for stack traces, but neither variables nor types: they take a third of the time to compile.
    # No NDEBUG: here assertions run, ours and those of the standard library's containers.
    set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O1 -g1")
    target_compile_options(inktrace_options INTERFACE
        -fsanitize=${INKTRACE_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer
        # Instrumented code makes GCC see uninitialised values where there are none.
        $<$<CXX_COMPILER_ID:GNU>:-Wno-maybe-uninitialized>)
    target_link_options(inktrace_options INTERFACE -fsanitize=${INKTRACE_SANITIZE})
    target_compile_definitions(inktrace_options INTERFACE
        _GLIBCXX_ASSERTIONS
        # Function multiversioning resolves symbols before a sanitizer's runtime is up.
        INKTRACE_NO_MULTIVERSION)
endif()

# inktrace_layer(NAME SOURCES ... USES layers... PRIVATE libs...): one folder of src/ as one target.
# USES are the layers below it (docs/architecture.md); PRIVATE are third parties that stay inside.
function(inktrace_layer name)
    cmake_parse_arguments(ARG "" "" "SOURCES;USES;PRIVATE" ${ARGN})
    if(ARG_SOURCES)
        add_library(${name} STATIC ${ARG_SOURCES})
        target_link_libraries(${name} PUBLIC ${ARG_USES} PRIVATE inktrace_options ${ARG_PRIVATE})
        target_include_directories(${name} PUBLIC ${PROJECT_SOURCE_DIR}/src)
    else()
        add_library(${name} INTERFACE)
        target_link_libraries(${name} INTERFACE ${ARG_USES})
        target_include_directories(${name} INTERFACE ${PROJECT_SOURCE_DIR}/src)
    endif()
    inktrace_layer_uses(${name} ${ARG_USES})
endfunction()

# inktrace_layer_uses(NAME layers...): notes all that is below a layer, for tests/layers_test.cmake.
function(inktrace_layer_uses name)
    set(below)
    foreach(layer IN LISTS ARGN)
        if(layer MATCHES "^ink_")
            get_property(more GLOBAL PROPERTY INKTRACE_BELOW_${layer})
            list(APPEND below ${layer} ${more})
        endif()
    endforeach()
    list(REMOVE_DUPLICATES below)
    set_property(GLOBAL PROPERTY INKTRACE_BELOW_${name} ${below})
    list(JOIN below " " text)
    set_property(GLOBAL APPEND PROPERTY INKTRACE_LAYERS "${name}: ${text}")
endfunction()

# inktrace_compile_fast(TARGET): for code that is compiled more often than it runs (tests, the
# command line), where optimising takes half of the build and gains nothing.
function(inktrace_compile_fast target)
    if(INKTRACE_SANITIZE)
        target_compile_options(${target} PRIVATE -O0)
    else()
        target_compile_options(${target} PRIVATE -O1)
    endif()
endfunction()
