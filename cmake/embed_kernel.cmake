# Run by sonoloft_embed_kernel(): writes OUTPUT, a C++ file that holds the text of ROOT/FILE as `const char SYMBOL[]`.
set(include_line "#include \"(core/kernels/[^\"]*)\"")
file(READ "${ROOT}/${FILE}" text)
while(text MATCHES "${include_line}")
  set(line "${CMAKE_MATCH_0}")
  file(READ "${ROOT}/${CMAKE_MATCH_1}" included)
  string(REPLACE "#pragma once\n" "" included "${included}")
  string(REPLACE "${line}" "${included}" text "${text}")
endwhile()
# As numbers: string literals are limited in length, and nothing needs quoting.
string(HEX "${text}" hex)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${hex}")
file(WRITE "${OUTPUT}" "namespace sonoloft {
extern const char ${SYMBOL}[];
const char ${SYMBOL}[] = {${bytes}0};
}  // namespace sonoloft
")
