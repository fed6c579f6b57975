# Finds node and npm, for the viewer and for tests. Where they are missing, web/CMakeLists.txt reports what to do.

set(SCANLOOM_NODE_MAJOR 18)
# Where the viewer's files are built to, and where the server looks for them.
set(SCANLOOM_WEB_DIR ${CMAKE_BINARY_DIR}/web)

find_program(SCANLOOM_NODE NAMES node nodejs DOC "Node.js, which builds the viewer")
find_program(SCANLOOM_NPM NAMES npm DOC "npm, which fetches what the viewer is built from")

# scanloom_find_npm(RESULT REASON): sets RESULT to whether node and npm are installed and new
# enough, and REASON to the cause if not.
function(scanloom_find_npm result reason)
  set(${result} FALSE PARENT_SCOPE)
  if(NOT SCANLOOM_NODE OR NOT SCANLOOM_NPM)
    set(${reason} "node or npm was not found" PARENT_SCOPE)
    return()
  endif()
  execute_process(COMMAND ${SCANLOOM_NODE} --version OUTPUT_VARIABLE version OUTPUT_STRIP_TRAILING_WHITESPACE)
  string(REGEX REPLACE "^v" "" version "${version}")
  if(version VERSION_LESS SCANLOOM_NODE_MAJOR)
    set(${reason} "node ${version} is older than ${SCANLOOM_NODE_MAJOR}" PARENT_SCOPE)
    return()
  endif()
  set(${result} TRUE PARENT_SCOPE)
endfunction()

# scanloom_npm_packages(DIRECTORY STAMP): a rule that installs what DIRECTORY/package-lock.json lists, and only then.
# npm writes STAMP last, so every build folder of this checkout shares one installation.
function(scanloom_npm_packages directory stamp)
  set(installed ${directory}/node_modules/.package-lock.json)
  add_custom_command(
    OUTPUT ${installed}
    COMMAND ${SCANLOOM_NPM} ci --no-audit --no-fund --loglevel=error
    COMMAND ${CMAKE_COMMAND} -E touch ${installed}
    DEPENDS ${directory}/package.json ${directory}/package-lock.json ${directory}/.npmrc
    WORKING_DIRECTORY ${directory}
    COMMENT "Installing the packages of ${directory}"
    VERBATIM)
  set(${stamp} ${installed} PARENT_SCOPE)
endfunction()
