# cmake -DINPUT=file -DOUTPUT=file.inc -DNAME=symbol -P EmbedFile.cmake: writes the bytes of a file as a C++ array, aligned to 4.
file(READ ${INPUT} hex HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE ${OUTPUT} "alignas(4) constexpr unsigned char ${NAME}[] = {${bytes}};\n")
