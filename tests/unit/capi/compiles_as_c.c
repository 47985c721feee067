/* sonoloft.h is C11, and its structs are what C programs were compiled with. */
#include "host/capi/sonoloft.h"

size_t sizes_in_c(size_t index);

/* In the order of the table in capi_mesh_test.cpp. */
size_t sizes_in_c(size_t index) {
  static const size_t sizes[] = {
      sizeof(sonoloft_error),        sizeof(sonoloft_simulation), sizeof(sonoloft_mesh_info),
      sizeof(sonoloft_mesh_arrays),  sizeof(sonoloft_contour),    sizeof(sonoloft_slice),
      sizeof(sonoloft_scan_options), sizeof(sonoloft_callbacks),  sizeof(sonoloft_statistics),
      sizeof(sonoloft_coverage),     sizeof(sonoloft_chunk),      sizeof(sonoloft_event),
      sizeof(sonoloft_transport)};
  return sizes[index];
}
