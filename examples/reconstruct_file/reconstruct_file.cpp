// Recorded slices become a mesh file.
#include <cstdio>

#include "core/io/meshes/mesh_files.h"
#include "core/io/slices/slice_files.h"
#include "core/reconstructor/reconstructor.h"

using namespace sonoloft;

namespace {

Result<void> reconstruct(const char* input, const char* output) {
  const auto file = read_csl(input);
  if (!file) return tl::unexpected<Error>(file.error());
  const auto options = options_for(file->slices, 6);  // the object is some 60 cells long
  if (!options) return tl::unexpected<Error>(options.error());
  auto reconstructor = Reconstructor::create(*options);
  if (!reconstructor) return tl::unexpected<Error>(reconstructor.error());
  for (const TrackedSlice& slice : file->slices)
    if (const auto added = reconstructor->add(slice); !added)
      std::printf("slice %llu is left out: %s\n", static_cast<unsigned long long>(slice.id),
                  added.error().message.c_str());
  if (const auto updated = reconstructor->update(); !updated) return tl::unexpected<Error>(updated.error());
  const IndexedMesh mesh = reconstructor->mesh().indexed();
  std::printf("%zu slices, %zu triangles\n", file->slices.size(), mesh.triangles.size());
  return write_ply(mesh, output);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return std::fprintf(stderr, "usage: reconstruct_file slices.csl mesh.ply\n"), 2;
  const auto done = reconstruct(argv[1], argv[2]);
  if (!done) return std::fprintf(stderr, "%s\n", done.error().message.c_str()), 1;
}
