# palpate_embed_text(OUT.cpp HEADER NAME FILE [NAME FILE ...]): writes a C++ file that defines `const std::string_view NAME`
# with each file's bytes, declared in the header. Done at configure time, again whenever a file changes.
function(palpate_embed_text out header)
  set(code "#include \"${header}\"\nnamespace palpate {\n")
  set(pairs ${ARGN})
  while(pairs)
    list(POP_FRONT pairs name file)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "([0-9a-f][0-9a-f])" "'\\\\x\\1'," bytes "${bytes}")
    string(APPEND code "static const char ${name}Bytes[] = {${bytes}};\n"
                       "const std::string_view ${name}(${name}Bytes, sizeof(${name}Bytes));\n")
  endwhile()
  file(GENERATE OUTPUT ${out} CONTENT "${code}}  // namespace palpate\n")
endfunction()
