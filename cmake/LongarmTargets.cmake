# Targets of this project: longarm_library, longarm_test; flags shared by all of them.
find_program(LONGARM_CCACHE_PROGRAM ccache)
if(LONGARM_CCACHE AND LONGARM_CCACHE_PROGRAM)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
      CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
      CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 ${LONGARM_CCACHE_PROGRAM})
endif()

add_library(longarm_build INTERFACE)
target_compile_features(longarm_build INTERFACE cxx_std_17)
target_compile_options(longarm_build INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
  -Woverloaded-virtual $<$<BOOL:${LONGARM_WERROR}>:-Werror>)
target_include_directories(longarm_build INTERFACE ${PROJECT_SOURCE_DIR})
set(LONGARM_QT_DEFINITIONS QT_NO_KEYWORDS QT_USE_QSTRINGBUILDER QT_DISABLE_DEPRECATED_BEFORE=0x050F00)

# longarm_library(vision SOURCES .. PUBLIC .. PRIVATE .. [PCH header ..] [QT])
function(longarm_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "QT" "" "SOURCES;PUBLIC;PRIVATE;PCH")
  add_library(longarm_${name} STATIC ${arg_SOURCES})
  add_library(longarm::${name} ALIAS longarm_${name})
  target_link_libraries(longarm_${name} PUBLIC longarm_build ${arg_PUBLIC} PRIVATE ${arg_PRIVATE})
  if(arg_QT)
    set_target_properties(longarm_${name} PROPERTIES AUTOMOC ON AUTORCC ON)
    target_compile_definitions(longarm_${name} PRIVATE ${LONGARM_QT_DEFINITIONS})
  endif()
  if(arg_PCH)
    target_precompile_headers(longarm_${name} PRIVATE ${arg_PCH})
  endif()
endfunction()

# longarm_test(vision SOURCES a_test.cpp .. LINK longarm::vision [LABEL unit|gui|gl] [QT] [PCH header ..])
# One executable; unit and gui tests are registered case by case, gl tests as one run under Xvfb.
# Campaigns are cases whose suite name ends in "Campaign": they carry the label "campaign", are left out of the
# default run and are started with:  ctest -L campaign  (or the executable with --gtest_filter='*Campaign*').
function(longarm_test name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "QT" "LABEL;TIMEOUT" "SOURCES;LINK;PCH")
  if(NOT arg_LABEL)
    set(arg_LABEL unit)
  endif()
  if(NOT arg_TIMEOUT)
    set(arg_TIMEOUT 120)
  endif()
  set(target test_${name})
  set(main test_main.cpp)
  if(arg_LABEL STREQUAL "gui" OR (arg_LABEL STREQUAL "gl" AND arg_QT))
    set(main gui_main.cpp)  # an application, and every unexpected Qt warning fails the test
  endif()
  add_executable(${target} ${arg_SOURCES} ${PROJECT_SOURCE_DIR}/tests/support/${main})
  target_link_libraries(${target} PRIVATE longarm_build ${arg_LINK} GTest::gtest)
  if(arg_QT)
    set_target_properties(${target} PROPERTIES AUTOMOC ON)
    target_compile_definitions(${target} PRIVATE ${LONGARM_QT_DEFINITIONS})
  endif()
  if(main STREQUAL "gui_main.cpp")
    target_link_libraries(${target} PRIVATE Qt5::Widgets Qt5::Test)
    if("longarm::widgets" IN_LIST arg_LINK OR "longarm::ui" IN_LIST arg_LINK)
      target_compile_definitions(${target} PRIVATE LONGARM_GUI_TEST_RESOURCES)
    endif()
  endif()
  if(arg_PCH)
    target_precompile_headers(${target} PRIVATE ${arg_PCH})
  endif()
  if(arg_LABEL STREQUAL "gl")
    add_test(NAME ${name}
      COMMAND xvfb-run -a -s "-screen 0 1920x1080x24" $<TARGET_FILE:${target}> --gtest_filter=-*Campaign*)
    # Alone: the window, the robot and software OpenGL share the processor with nobody.
    set_tests_properties(${name} PROPERTIES LABELS gl TIMEOUT 900 RUN_SERIAL TRUE
      ENVIRONMENT "QT_QPA_PLATFORM=xcb;LIBGL_ALWAYS_SOFTWARE=1")
  else()
    set(environment "")
    if(arg_LABEL STREQUAL "gui")
      set(environment ENVIRONMENT QT_QPA_PLATFORM=offscreen)
    endif()
    include(GoogleTest)
    gtest_discover_tests(${target} TEST_PREFIX "${name}/" TEST_FILTER "-*Campaign*" DISCOVERY_TIMEOUT 120
      DISCOVERY_MODE PRE_TEST PROPERTIES LABELS ${arg_LABEL} TIMEOUT ${arg_TIMEOUT} ${environment})
  endif()
  set_property(GLOBAL APPEND PROPERTY LONGARM_TEST_EXECUTABLES ${target})
endfunction()
