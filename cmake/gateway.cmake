# How the project's targets are declared. All take SOURCES (relative to the caller's folder) and LINK.
#   gateway_room(<target> SOURCES … LINK …)      a room as static library; what it links its users see too
#   gateway_program(<target> SOURCES … LINK …)   an executable
#   gateway_test(<target> SOURCES … LINK …)      a GoogleTest executable, two ctest tests: every second case each
#   gateway_vcan_test(<target> SOURCES … LINK …) a GoogleTest executable that runs where vcan0 is, one ctest test
#   gateway_system_test(<name> <script>)         a script that runs there too; $GATEWAY_BIN is the program, one ctest test

# What every target of ours is compiled with. The presets make warnings errors (CMAKE_COMPILE_WARNING_AS_ERROR); who
# builds without one may have a compiler that knows more of them. Release builds keep line numbers for crash reports.
add_library(gateway_options INTERFACE)
target_compile_features(gateway_options INTERFACE cxx_std_20)
target_include_directories(gateway_options INTERFACE "${PROJECT_SOURCE_DIR}")
target_link_libraries(gateway_options INTERFACE deps::asio)
target_compile_options(gateway_options INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wsign-conversion -Wshadow -Wold-style-cast -Wnon-virtual-dtor
  -Woverloaded-virtual)

# What is installed names no folder of the machine that built it.
add_compile_options("$<$<CONFIG:Release>:-g1;-fstack-protector-strong;-D_FORTIFY_SOURCE=2;-ffile-prefix-map=${PROJECT_SOURCE_DIR}/=>")
add_link_options("$<$<CONFIG:Release>:-Wl,-z,relro,-z,now>")
# g++ keeps this warning to headers, and takes files that are compiled as one for headers. Every other warning stays, and
# the release compiles each file by itself.
if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options(-Wno-subobject-linkage)
endif()
# The precompiled headers are more than g++ means to keep before it collects garbage: each collection walks through them
# and finds nothing. Half a gigabyte before the first one saves an eighth of the time.
if(CMAKE_CXX_COMPILER_ID STREQUAL GNU)
  add_compile_options("$<$<COMPILE_LANGUAGE:CXX>:SHELL:--param ggc-min-heapsize=600000>")
endif()
if(GATEWAY_SANITIZE)
  add_compile_options(-fsanitize=${GATEWAY_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options(-fsanitize=${GATEWAY_SANITIZE})
endif()

# The headers nearly every file includes, precompiled once for rooms and programs, and once more with GoogleTest.
# -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON does without; every file must compile that way too.
set(GATEWAY_COMMON_HEADERS
  <algorithm> <array> <chrono> <cstdint> <functional> <map> <memory> <optional> <span> <string> <string_view>
  <unordered_map> <utility> <variant> <vector>
  <boost/asio/any_io_executor.hpp> <boost/asio/awaitable.hpp> <boost/asio/basic_waitable_timer.hpp>
  <boost/asio/co_spawn.hpp> <boost/asio/io_context.hpp> <boost/asio/post.hpp>
  <boost/asio/redirect_error.hpp> <boost/asio/use_awaitable.hpp> <boost/system/result.hpp>)

function(gateway_precompiled name)
  file(CONFIGURE OUTPUT "${CMAKE_BINARY_DIR}/precompiled/${name}.cpp" CONTENT "")  # untouched where it is there
  add_library(${name} OBJECT "${CMAKE_BINARY_DIR}/precompiled/${name}.cpp")
  target_link_libraries(${name} PRIVATE gateway_options ${ARGN})
endfunction()

gateway_precompiled(precompiled)
target_precompile_headers(precompiled PRIVATE ${GATEWAY_COMMON_HEADERS})

function(gateway_room name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_library(${name} STATIC ${arg_SOURCES})
  target_link_libraries(${name} PUBLIC gateway_options ${arg_LINK})
  target_precompile_headers(${name} REUSE_FROM precompiled)
endfunction()

function(gateway_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE gateway_options ${arg_LINK})
  target_precompile_headers(${name} REUSE_FROM precompiled)
endfunction()

if((GATEWAY_TESTS OR GATEWAY_VCAN_TESTS) AND NOT GATEWAY_FUZZ)
  find_package(GTest 1.12 REQUIRED CONFIG)
  gateway_precompiled(precompiled_test GTest::gmock GTest::gtest)
  target_precompile_headers(precompiled_test PRIVATE ${GATEWAY_COMMON_HEADERS} <gmock/gmock.h> <gtest/gtest.h>)
endif()

# Tests find files of the repository with GATEWAY_SOURCE_DIR, an absolute path without a slash at its end.
function(gateway_test_program name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;LINK")
  add_executable(${name} ${arg_SOURCES})
  target_link_libraries(${name} PRIVATE gateway_options ${arg_LINK} GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE GATEWAY_SOURCE_DIR="${PROJECT_SOURCE_DIR}")
  target_precompile_headers(${name} REUSE_FROM precompiled_test)
endfunction()

# ./test gives ctest two places for each processor and one more. What works takes two places,
# what waits more than it works takes one: one that waits runs beside as many that work as there are processors.
set(GATEWAY_WORKS PROCESSORS 2)
set(GATEWAY_WAITS PROCESSORS 1)
# What has no deadline gives way to what has: the user-mode kernel finds a processor whenever it needs it.
set(GATEWAY_GIVES_WAY nice -n 19)

# A process for each case would take longer to start than most cases take. Two of a program keep two processors busy.
# GoogleTest names a case before it runs, so the last line of one that crashes or hangs names it. A program without
# cases, and a case that is skipped, would pass.
function(gateway_test name)
  gateway_test_program(${name} ${ARGN})
  target_sources(${name} PRIVATE "${PROJECT_SOURCE_DIR}/tests/support/no_timerfd.cpp")
  set(shards 2)
  foreach(shard RANGE 1 ${shards})
    math(EXPR index "${shard} - 1")
    add_test(NAME ${name}.${shard} COMMAND ${GATEWAY_GIVES_WAY} $<TARGET_FILE:${name}>)
    set_tests_properties(${name}.${shard} PROPERTIES LABELS unit TIMEOUT 300 ${GATEWAY_WORKS}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=${shards};GTEST_SHARD_INDEX=${index}"
      FAIL_REGULAR_EXPRESSION "Running 0 tests;\\[  SKIPPED \\]")
  endforeach()
endfunction()

# What is tested on vcan is the release build: AddressSanitizer does not run in the user-mode kernel, and this is what
# is installed. They know deadlines, and the user-mode kernel has one processor: one of them at a time, and what else runs
# gives way. Half of the time they wait. They make the longest chain, so it begins first.
function(gateway_add_vcan_test name)
  add_test(NAME vcan.${name} COMMAND "${PROJECT_SOURCE_DIR}/tests/vcan/run" -t 280 -- ${ARGN})
  set_tests_properties(vcan.${name} PROPERTIES LABELS vcan TIMEOUT 300 RESOURCE_LOCK vcan COST 2000 ${GATEWAY_WAITS}
    ENVIRONMENT "GATEWAY_BIN=${GATEWAY_RELEASE_DIR}/daemon/canopen-gateway")
endfunction()

function(gateway_vcan_test name)
  if(GATEWAY_VCAN_TESTS)
    gateway_test_program(${name} ${ARGN})
  endif()
  if(GATEWAY_CHECKS)
    cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE folder)
    gateway_add_vcan_test(${name} "${GATEWAY_RELEASE_DIR}/${folder}/${name}")
  endif()
endfunction()

function(gateway_system_test name script)
  if(GATEWAY_CHECKS)
    gateway_add_vcan_test(${name} "${CMAKE_CURRENT_SOURCE_DIR}/${script}")
  endif()
endfunction()
