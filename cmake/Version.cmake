# cmake -DSOURCE=dir -DOUTPUT=file -DVERSION=x.y.z -P Version.cmake: writes version and commit as C++ constants. The file
# is touched only when they change.
execute_process(COMMAND git -C ${SOURCE} describe --always --dirty --abbrev=10 --exclude=*
  OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
if(failed)
  set(commit "unknown")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT "constexpr const char* kVersion = \"${VERSION}\";\nconstexpr const char* kCommit = \"${commit}\";\n")
