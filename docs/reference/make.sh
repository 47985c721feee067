#!/usr/bin/env bash
# The reference as pages, out of the headers; fails where these say something that makes no sense to Doxygen.
#   make.sh <output folder>      exit status 77: there is no Doxygen
set -euo pipefail
output="$(mkdir -p "$1" && cd "$1" && pwd)"
cd "$(dirname "$(readlink -f "$0")")/../.."
command -v doxygen >/dev/null || {
  echo "SKIP: no doxygen; on Debian: apt-get install doxygen"
  exit 77
}
version="$(sed -n 's/^project(SonoLoft VERSION \([0-9.]*\).*/\1/p' CMakeLists.txt)"
{
  cat docs/reference/Doxyfile
  echo "OUTPUT_DIRECTORY = \"$output\""
  echo "PROJECT_NUMBER = $version"
} | doxygen -
echo "$output/html/index.html"
