/* A scan in C: the last mesh is kept and written as an OBJ file. */
#include <sonoloft.h>
#include <stdatomic.h>
#include <stdio.h>
#include <threads.h>

typedef struct Viewer {
  sonoloft_mesh* last;
  atomic_int ended;
} Viewer;

static void on_mesh(void* user, sonoloft_mesh* mesh) {
  Viewer* viewer = user;
  sonoloft_mesh_release(viewer->last);
  viewer->last = sonoloft_mesh_retain(mesh); /* ours beyond this call */
  printf("slice %2llu\n", (unsigned long long)sonoloft_mesh_get_info(mesh)->revision);
}

static void on_event(void* user, const sonoloft_event* event) {
  Viewer* viewer = user;
  printf("%s\n", event->message);
  if (event->ends_run) atomic_store(&viewer->ended, 1);
}

static int write_obj(const sonoloft_mesh_arrays* mesh, const char* path) {
  FILE* file = fopen(path, "w");
  if (!file) return 0;
  for (size_t v = 0; v < mesh->vertices; ++v) {
    const float* p = mesh->positions_mm + 3 * v;
    fprintf(file, "v %g %g %g\n", (double)p[0], (double)p[1], (double)p[2]);
  }
  for (size_t t = 0; t < mesh->triangles; ++t) {
    const uint32_t* c = mesh->corners + 3 * t;
    fprintf(file, "f %u %u %u\n", c[0] + 1, c[1] + 1, c[2] + 1);
  }
  return fclose(file) == 0;
}

static int fail(const sonoloft_error* error) {
  fprintf(stderr, "%s: %s\n", sonoloft_status_name(error->status), error->message);
  return 1;
}

int main(int argc, char** argv) {
  sonoloft_simulation simulation = {.size = sizeof simulation, .slices = 40, .rate_hz = 20};
  sonoloft_scan_options options = {
      .size = sizeof options, .box_min_mm = {-300, -300, -300}, .box_max_mm = {300, 300, 300}, .spacing_mm = 4};
  Viewer viewer = {0};
  sonoloft_callbacks callbacks = {.size = sizeof callbacks, .user = &viewer, .on_mesh = on_mesh, .on_event = on_event};
  sonoloft_error error;
  sonoloft_probe* probe;
  sonoloft_scan* scan;

  if (sonoloft_open_simulated(&simulation, &probe, &error) != SONOLOFT_OK) return fail(&error);
  if (sonoloft_scan_open(probe, &options, &scan, &error) != SONOLOFT_OK) return fail(&error);
  if (sonoloft_scan_start(scan, &callbacks, &error) != SONOLOFT_OK) return fail(&error);
  while (!atomic_load(&viewer.ended)) thrd_sleep(&(struct timespec){.tv_nsec = 10000000}, NULL);
  sonoloft_scan_close(scan);
  if (!viewer.last) return 1;

  const sonoloft_mesh_info* info = sonoloft_mesh_get_info(viewer.last);
  const sonoloft_mesh_arrays* mesh = sonoloft_mesh_get_arrays(viewer.last);
  printf("%zu vertices, %zu triangles\n", mesh->vertices, mesh->triangles);
  for (size_t i = 0; i < info->labels; ++i) {
    const sonoloft_label* label = sonoloft_mesh_label(viewer.last, i);
    printf("  label %u: %.0f ml\n", label->label, label->volume_ml);
  }
  const int written = write_obj(mesh, argc > 1 ? argv[1] : "mesh.obj");
  sonoloft_mesh_release(viewer.last);
  return written ? 0 : 1;
}
