# cmake -DSOURCE=... -DLAYERS=... -P layers_test.cmake: whether every folder of src/ includes only what
# docs/architecture.md allows it. LAYERS has a line a layer, "NAME: layers below it", as they are
# linked; all layers share one include path, so that the compiler would find any other, too.

cmake_minimum_required(VERSION 3.25)

# What `lines` may know of those who make samples: types, of which nothing needs to be linked.
set(headers_for_lines scene/ids.h sampling/samples.h sampling/surface_key.h sampling/mesh_crossing.h)

# Third parties stay inside the layers that need them: "pattern of headers|layers".
set(third_parties
    "embree[34]/|accel" "tbb/|base" "hwy/|accel base film lines render sampling scene shading"
    "(assimp|gemmi)/|io" "(png|jpeglib|tiffio|zlib|half|Imf[A-Za-z]+)\\.h|io" "pugixml|io"
    "nlohmann/|io vector" "cairo|vector")

file(STRINGS ${LAYERS} table)
foreach(line IN LISTS table)
    string(REGEX MATCH "^([a-z]+):(.*)$" _ "${line}")
    set(layer ${CMAKE_MATCH_1})
    separate_arguments(below UNIX_COMMAND "${CMAKE_MATCH_2}")
    list(APPEND layers ${layer})
    set(allowed_${layer} ${layer} ${below})
endforeach()

if(NOT layers)
    message(FATAL_ERROR "${LAYERS} lists no layers")
endif()
foreach(layer IN LISTS layers)
    file(GLOB files RELATIVE ${SOURCE} ${SOURCE}/${layer}/*.h ${SOURCE}/${layer}/*.cpp)
    if(NOT files)
        message(SEND_ERROR "src/${layer} has no files")
    endif()
    foreach(file IN LISTS files)
        file(STRINGS ${SOURCE}/${file} includes REGEX "^#include [<\"]")
        foreach(include IN LISTS includes)
            if(include MATCHES "^#include \"(([a-z]+)/.*)\"")
                set(header ${CMAKE_MATCH_1})
                set(folder ${CMAKE_MATCH_2})
                if(NOT folder IN_LIST layers OR folder IN_LIST allowed_${layer}
                   OR (layer STREQUAL "lines" AND header IN_LIST headers_for_lines))
                    continue()
                endif()
                message(SEND_ERROR "src/${file} includes ${header}, which is not below ${layer}")
            endif()
            foreach(party IN LISTS third_parties)
                string(REGEX MATCH "^(.*)\\|(.*)$" _ "${party}")
                set(pattern ${CMAKE_MATCH_1})
                separate_arguments(users UNIX_COMMAND "${CMAKE_MATCH_2}")
                if(include MATCHES "^#include <${pattern}" AND NOT layer IN_LIST users)
                    message(SEND_ERROR "src/${file}: ${include} belongs to ${users} alone")
                endif()
            endforeach()
        endforeach()
    endforeach()
endforeach()
