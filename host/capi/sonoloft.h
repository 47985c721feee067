#pragma once
/* SonoLoft for C, and for whatever calls C: slices of a tracked ultrasound probe in, live closed multi-label meshes
 * out.
 *
 *   probe (USB, simulated, your own) -> sonoloft_scan -> your callbacks with a sonoloft_mesh
 *
 * Units: mm, right-handed; ns of the device's clock. "Reference" is the tracker's fixed frame.
 *
 * Errors. What can fail returns a sonoloft_status, and says more in `error`, which may be NULL: one line that names
 * cause and remedy. A NULL where an object is due is SONOLOFT_INVALID_ARGUMENT. Outputs are written on SONOLOFT_OK
 * only.
 *
 * Structs that grow. Those that begin with `size` are filled in by you: set all to 0, `size` to sizeof the struct, then
 * what you want; a field that is 0 has its default. Later versions add fields at the end; an older library refuses
 * those that are not 0. Structs that the library hands to you by pointer grow at their end, too: never copy arrays of
 * them.
 *
 * Threads. Any function may be called from any thread, and inside every callback but where it says otherwise.
 *
 * Strings are UTF-8, zero-terminated. */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Errors ---- */

/* The codes of docs/errors.md. */
typedef enum sonoloft_status {
  SONOLOFT_OK = 0,
  SONOLOFT_INVALID_ARGUMENT = 1,
  SONOLOFT_FILE_NOT_FOUND = 2,
  SONOLOFT_IO_FAILED = 3,
  SONOLOFT_UNSUPPORTED_FORMAT = 4,
  SONOLOFT_PARSE_FAILED = 5,
  SONOLOFT_EMPTY_INPUT = 6,
  SONOLOFT_NON_FINITE = 7,
  SONOLOFT_NON_PLANAR = 8,
  SONOLOFT_BAD_CONTOUR = 9,
  SONOLOFT_TOO_LARGE = 10,
  SONOLOFT_NOT_RIGID = 11,
  SONOLOFT_OUTSIDE_BOX = 12,
  SONOLOFT_CELL_LIMIT = 13,
  SONOLOFT_DEVICE_NOT_FOUND = 14,
  SONOLOFT_TRANSPORT_CLOSED = 15,
  SONOLOFT_TIMED_OUT = 16,
  SONOLOFT_PROTOCOL_MISMATCH = 17,
  SONOLOFT_WRONG_STATE = 18,
  SONOLOFT_REFUSED_BY_DEVICE = 19,
  SONOLOFT_NO_OPENCL_DEVICE = 20,
  SONOLOFT_OPENCL_FAILED = 21,
  SONOLOFT_NOT_AVAILABLE = 22,
  SONOLOFT_OUT_OF_MEMORY = 100
} sonoloft_status;

typedef struct sonoloft_error {
  sonoloft_status status;
  char message[508]; /* what is longer is cut */
} sonoloft_error;

/* The name of a status, e.g. "device_not_found"; never NULL. */
const char* sonoloft_status_name(sonoloft_status status);

/* Of the library, e.g. "1.2.3". */
const char* sonoloft_version(void);

/* ---- Probes ---- */

/* An opened way to a device. Give it to one scan, or close it. */
typedef struct sonoloft_probe sonoloft_probe;

typedef struct sonoloft_usb_device {
  const char* serial;   /* "" where it could not be asked */
  const char* location; /* bus and ports, e.g. "1-2.4" */
  int32_t speed_mbit;   /* as negotiated; 0: unknown */
  uint8_t protocol_major, protocol_minor;
  sonoloft_status problem; /* why it could not be asked */
  const char* problem_message;
} sonoloft_usb_device;

/* Visits all probes on USB, on this thread; what `device` points to lives during the call only. Another program may be
 * using them: nothing of them is touched but the serial number is read. Milliseconds a probe. */
sonoloft_status sonoloft_list_usb(void (*visit)(void* user, const sonoloft_usb_device* device), void* user,
                                  sonoloft_error* error);

/* Tells of probes that are plugged in and out, and at first of those that are there: on a thread of its own, one call
 * at a time. `location` lives during the call only. */
typedef struct sonoloft_usb_watch sonoloft_usb_watch;
typedef void (*sonoloft_plug_callback)(void* user, int arrived, const char* location);
sonoloft_status sonoloft_watch_usb(sonoloft_plug_callback callback, void* user, sonoloft_usb_watch** watch,
                                   sonoloft_error* error);

/* Waits for a callback that runs; none runs afterwards. Not from the callback. NULL does nothing. */
void sonoloft_unwatch_usb(sonoloft_usb_watch* watch);

/* Opens the probe with this serial number, or the only one where it is NULL or "". */
sonoloft_status sonoloft_open_usb(const char* serial, sonoloft_probe** probe, sonoloft_error* error);

typedef enum sonoloft_phantom {
  SONOLOFT_ORGANS = 0, /* an abdomen of five labels, seen whole */
  SONOLOFT_TORSO = 1   /* as a patient is scanned: ribs that shadow, noise, lost contact */
} sonoloft_phantom;

typedef struct sonoloft_simulation {
  size_t size;
  int32_t phantom; /* a sonoloft_phantom */
  uint32_t slices; /* up to 100000, then the data end; default 60 */
  double rate_hz;  /* up to 1000; default: as fast as they are used */
  uint64_t seed;   /* of the hand that moves the probe, and of all noise; default 1 */
} sonoloft_simulation;

/* A probe that lives in this process. The phantoms lie within 130 mm of the origin. */
sonoloft_status sonoloft_open_simulated(const sonoloft_simulation* simulation, sonoloft_probe** probe,
                                        sonoloft_error* error);

/* Where a transport of yours puts what it receives; lives from start_stream() to the return of stop_stream(). */
typedef struct sonoloft_sink sonoloft_sink;

/* A way of your own to reach a device, which need not know what the bytes mean; host/device/transport.h says more. All
 * but `close` and `send_block` is needed; threads are yours. */
typedef struct sonoloft_transport {
  size_t size;
  void* user; /* comes back in every call */
  /* One request and its reply, of up to `room` bytes. On any thread but that which calls the sink; calls come together
   * and are to wait for each other. TRANSPORT_CLOSED: the device went away; TIMED_OUT; IO_FAILED. */
  sonoloft_status (*control)(void* user, const void* request, size_t request_length, void* reply, size_t room,
                             size_t* reply_length, uint32_t timeout_ms);
  /* Throws away what an earlier session left in the pipe, then hands transfers of up to `max_record` bytes to the sink,
   * in order, on one thread of yours, until stop_stream(). */
  sonoloft_status (*start_stream)(void* user, sonoloft_sink* sink, size_t max_record);
  /* Returns after the last call into the sink has returned. Legal when no stream runs. */
  void (*stop_stream)(void* user);
  /* The last call of all. */
  void (*close)(void* user);
  /* Sends one block of a blob; on any thread but that which calls the sink. NULL: this way takes none. */
  sonoloft_status (*send_block)(void* user, const void* bytes, size_t length, uint32_t timeout_ms);
} sonoloft_transport;

/* One finished transfer; may block, which is to hold later ones on the device's side. Copied once where `bytes` are not
 * 64-byte aligned. */
void sonoloft_sink_transfer(sonoloft_sink* sink, const void* bytes, size_t length);
/* Something that the device tells by itself; on any thread, also while a transfer is handed over; does not block. */
void sonoloft_sink_event(sonoloft_sink* sink, const void* bytes, size_t length);
/* The device went away: nothing follows. */
void sonoloft_sink_gone(sonoloft_sink* sink);

/* `transport` is copied. Where it fails `close` is not called. */
sonoloft_status sonoloft_open_transport(const sonoloft_transport* transport, sonoloft_probe** probe,
                                        sonoloft_error* error);

/* Of a probe that no scan has. NULL does nothing. */
void sonoloft_close_probe(sonoloft_probe* probe);

/* ---- Meshes ---- */

/* The mesh of all slices so far, and what became of those that were new. Immutable, counted: a callback has it during
 * the call; retain it to keep it, as long as you like, also after the scan was closed. */
typedef struct sonoloft_mesh sonoloft_mesh;

sonoloft_mesh* sonoloft_mesh_retain(sonoloft_mesh* mesh);
/* The last release frees it and all that was read from it. NULL does nothing. */
void sonoloft_mesh_release(sonoloft_mesh* mesh);

typedef enum sonoloft_detail {
  SONOLOFT_FULL = 0,
  SONOLOFT_COARSE = 1, /* at twice the spacing, while slices come faster than full meshes take */
  SONOLOFT_DRAFT = 2   /* at four times the spacing */
} sonoloft_detail;

typedef struct sonoloft_mesh_info {
  uint64_t revision;          /* slices taken in so far */
  uint64_t skipped_revisions; /* of them never delivered by themselves */
  sonoloft_detail detail;
  int32_t settled; /* 0: while slices come, cells around them wait for a pause to follow them too */
  size_t labels;   /* with a surface: see sonoloft_mesh_label() */
  size_t slices; /* new since the mesh before: see sonoloft_mesh_slice() */
  double reconstruct_ms;
} sonoloft_mesh_info;
const sonoloft_mesh_info* sonoloft_mesh_get_info(const sonoloft_mesh* mesh);

/* One network of surfaces with shared vertices, the boundary of every label closed. The triangles run counter-clockwise
 * seen from the label in front of them; label 0 is outside. Reference frame. */
typedef struct sonoloft_mesh_arrays {
  size_t vertices, triangles;
  const float* positions_mm;   /* [3 * vertices] x y z */
  const uint32_t* corners;     /* [3 * triangles] indices of vertices */
  const uint16_t* label_pairs; /* [2 * triangles] in front, behind; never equal */
} sonoloft_mesh_arrays;
/* The first call joins the chunks of the mesh, some ns a triangle. NULL: out of memory. */
const sonoloft_mesh_arrays* sonoloft_mesh_get_arrays(const sonoloft_mesh* mesh);

/* A part of the mesh: its triangles in a cube of space. Vertices on its border are repeated in the chunks beside it. */
typedef struct sonoloft_chunk {
  int32_t x, y, z; /* which cube: by this it is known in every mesh */
  size_t vertices, triangles;
  const float* positions_mm;   /* [3 * vertices] */
  const uint32_t* corners;     /* [3 * triangles] indices of the chunk's vertices */
  const uint16_t* label_pairs; /* [2 * triangles] */
} sonoloft_chunk;
/* Chunks that changed, appeared or vanished (then without triangles) since the mesh delivered before: what a graphics
 * card has to be told. After a change of detail, all of them. */
size_t sonoloft_mesh_changed_chunks(const sonoloft_mesh* mesh);
/* NULL: there is no such index, or out of memory. */
const sonoloft_chunk* sonoloft_mesh_changed_chunk(const sonoloft_mesh* mesh, size_t index);

typedef struct sonoloft_label {
  uint16_t label;   /* a material, from 1 on */
  size_t triangles; /* that bound it */
  double volume_ml;
} sonoloft_label;
/* Ascending by label. NULL: there is no such index. */
const sonoloft_label* sonoloft_mesh_label(const sonoloft_mesh* mesh, size_t index);

/* ---- Slices ---- */

typedef enum sonoloft_fate {
  SONOLOFT_INSERTED = 0,  /* the mesh may have changed */
  SONOLOFT_EXPLAINED = 1, /* it says what was known already */
  SONOLOFT_MERGED = 2,    /* it says something new, but lies too near to others to be interpolated */
  SONOLOFT_REFUSED = 3,   /* it is not used, for the reason given */
  SONOLOFT_UNDECIDED = 4  /* of on_slice: the reconstruction has not seen it yet */
} sonoloft_fate;

enum { SONOLOFT_UNKNOWN_LABEL = 0xFFFF }; /* of a contour: not measured, a shadow */

/* Closed: the last point is joined to the first. This struct does not grow. */
typedef struct sonoloft_contour {
  uint32_t first, count; /* points */
  uint16_t label;        /* what it encloses */
  uint16_t hole;         /* not 0: it encloses outside, and label is not used */
} sonoloft_contour;

typedef struct sonoloft_slice {
  uint64_t id;                   /* the device's number of it */
  int64_t time_ns;               /* device clock, middle of the acquisition */
  int64_t pose_time_ns;          /* device clock, when the tracker measured */
  int32_t pose_ok;               /* 0: the tracker had no pose, and image_to_reference is not to be used */
  float pose_error_mm;           /* the tracker's estimate; 0: none */
  double image_to_reference[12]; /* 3 by 4, row by row, rigid: from mm in the slice's plane (x y, z the normal) */
  size_t points, contours, field_of_view_points;
  const double* points_mm;         /* [2 * points] x y, image */
  const sonoloft_contour* contour; /* [contours] */
  const double* field_of_view_mm;  /* [2 * field_of_view_points] closed polygon, image; none: the whole plane */
  sonoloft_fate fate;
  const char* reason; /* of a refused slice: cause and remedy */
  double latency_ms;  /* from the slice's arrival at this machine to on_mesh; of on_slice 0 */
} sonoloft_slice;
/* In the order of arrival; lives as long as the mesh. NULL: there is no such index. */
const sonoloft_slice* sonoloft_mesh_slice(const sonoloft_mesh* mesh, size_t index);

/* ---- Scans ---- */

/* A device and a reconstruction, joined: slices go into the mesh as they come, every new mesh goes to your callback. */
typedef struct sonoloft_scan sonoloft_scan;

/* Where an object ends beyond the first and the last of slices in parallel planes. */
typedef enum sonoloft_caps {
  SONOLOFT_CAPS_GAP = 0,   /* an empty plane one gap beyond: a flat end closes about half way to it */
  SONOLOFT_CAPS_SLICE = 1, /* at the slice itself */
  SONOLOFT_CAPS_BOX = 2    /* the surface runs out towards the walls of the box */
} sonoloft_caps;

typedef struct sonoloft_scan_options {
  size_t size;
  double box_min_mm[3], box_max_mm[3]; /* the space of the scan, reference: about one object larger than the object on
                                          every side; no default */
  double spacing_mm;                   /* what is finer is not drawn; no default */
  double background_mm;                /* about a 60th of the object; default 2.5 */
  int32_t threads;                     /* of the reconstruction; default 1; the mesh does not depend on it */
  int32_t processor_only;              /* not 0: no graphics device is used */
  int32_t interpolate_all; /* not 0: every slice is interpolated, for up to some hundred slices of a recorded set; else
                              those that say something new, for sweeps of any length */
  int32_t lossless;        /* not 0: where slices come too fast they hold the link back; else the oldest give way */
  uint32_t queue_slices;   /* that may wait for the reconstruction; default 256 */
  int32_t interpolate_poses; /* not 0: an image gets the pose of its time + pose_offset_ns, between two measured ones */
  int64_t pose_offset_ns;    /* as `sonoloft calibrate-time` measures */
  int32_t caps;              /* a sonoloft_caps */
  int32_t step_field;        /* not 0: between slices the published field, whose surface leaves each at a right angle */
} sonoloft_scan_options;

/* Opens the device and prepares the reconstruction, which the first time may take a second. Takes the probe, also where
 * it fails. */
sonoloft_status sonoloft_scan_open(sonoloft_probe* probe, const sonoloft_scan_options* options, sonoloft_scan** scan,
                                   sonoloft_error* error);

typedef enum sonoloft_event_kind {
  SONOLOFT_DISCONNECTED = 0,          /* the device went away: at most once a run, and its last callback */
  SONOLOFT_DEVICE_FAULT = 1,          /* the device stopped by itself */
  SONOLOFT_SLICES_DROPPED = 2,        /* slices come faster than they are used */
  SONOLOFT_CALLBACK_THREW = 3,        /* a C++ exception left on_mesh */
  SONOLOFT_RECONSTRUCTION_FAILED = 4, /* the run ends with this callback */
  SONOLOFT_END_OF_DATA = 5,           /* the device has no more slices, and the mesh of its last one was delivered */
  SONOLOFT_BUTTON = 6                 /* a button of the probe was pressed or let go */
} sonoloft_event_kind;

typedef struct sonoloft_event {
  sonoloft_event_kind kind;
  const char* message; /* one line, cause and remedy */
  uint16_t button;     /* of SONOLOFT_BUTTON: its number, from 0 */
  uint16_t pressed;    /* not 0: pressed; 0: let go */
  int64_t time_ns;     /* and when, device clock */
  int32_t ends_run;    /* not 0: no mesh of a new slice follows in this run */
} sonoloft_event;

/* Called on the scan's own thread, one call at a time, with no lock held. Each may be NULL. What they are given lives
 * during the call; a mesh may be retained. While one runs slices wait, the link does not. */
typedef struct sonoloft_callbacks {
  size_t size;
  void* user;
  void (*on_mesh)(void* user, sonoloft_mesh* mesh);
  void (*on_event)(void* user, const sonoloft_event* event);
  void (*on_slice)(void* user, const sonoloft_slice* slice); /* each in order, before the mesh that has it is made */
} sonoloft_callbacks;

/* Starts a run; later runs of a scan go on with the same mesh. Callbacks may come before it returns. A device that went
 * away is looked for. Not from a callback: SONOLOFT_WRONG_STATE. */
sonoloft_status sonoloft_scan_start(sonoloft_scan* scan, const sonoloft_callbacks* callbacks, sonoloft_error* error);

/* Ends the run; slices that still wait are dropped and counted. Legal at any time.
 * From a callback: marks and returns at once; that callback is the last.
 * From elsewhere: returns after the last callback has returned. So do not hold a lock that a callback waits for. */
void sonoloft_scan_stop(sonoloft_scan* scan);

/* Stops, and closes the device. From a callback: returns at once, that callback is the last, and the device is closed
 * on the scan's thread soon after. From elsewhere: everything is down on return. No other thread may be in a call with
 * this scan, but for a start whose first callback this is. NULL does nothing. */
void sonoloft_scan_close(sonoloft_scan* scan);

typedef enum sonoloft_blob_kind {
  SONOLOFT_BLOB_FIRMWARE = 1,   /* an image for the device to run */
  SONOLOFT_BLOB_CALIBRATION = 2 /* what its maker measured */
} sonoloft_blob_kind;
/* Sends a blob to the device, which keeps it. Not while a run goes on: SONOLOFT_WRONG_STATE; NOT_AVAILABLE: the device
 * takes none; REFUSED_BY_DEVICE: not what it takes. Waits until it is kept: seconds. */
sonoloft_status sonoloft_scan_send_blob(sonoloft_scan* scan, sonoloft_blob_kind kind, const void* bytes, size_t length,
                                        sonoloft_error* error);

/* Takes back a slice by its id: in a run a mesh without it follows at once. Waits for an update that runs. */
sonoloft_status sonoloft_scan_withdraw(sonoloft_scan* scan, uint64_t slice_id, sonoloft_error* error);

typedef struct sonoloft_device_info {
  const char* serial;
  const char* firmware_version;
  const char* field_device; /* where the reconstruction computes */
} sonoloft_device_info;
/* Lives as long as the scan. */
const sonoloft_device_info* sonoloft_scan_device(const sonoloft_scan* scan);

/* Where everything went. Slices, since the scan was opened, and whenever it is stopped:
 *   delivered == inserted + explained + merged + refused + dropped.
 * Records of the present or last run: made == sent_on + host_dropped + crc_bad + malformed + lost + device_dropped. */
typedef struct sonoloft_statistics {
  size_t size;
  uint64_t delivered, inserted, explained, merged, refused, dropped;
  uint64_t made, sent_on, host_dropped, crc_bad, malformed, lost, device_dropped;
  int32_t closed; /* not 0: the run has ended, and both sides agree on the sum */
} sonoloft_statistics;
/* You set `size`; as many bytes are written. */
sonoloft_status sonoloft_scan_statistics(const sonoloft_scan* scan, sonoloft_statistics* statistics,
                                         sonoloft_error* error);

/* What was seen, of the space that the materials in the slices span. */
typedef struct sonoloft_coverage {
  size_t size;
  double volume_ml, seen_ml;
  double gap_ml; /* the largest connected part that was not seen; 0: there is none, and the following is not set */
  double gap_centre_mm[3];
  double gap_image_to_reference[12]; /* a plane that shows most of it; as that of a slice */
  double near_mm;                    /* up to where a point counts as seen */
} sonoloft_coverage;
/* You set `size`; as many bytes are written. Some 50 ms; waits for an update that runs. */
sonoloft_status sonoloft_scan_coverage(const sonoloft_scan* scan, sonoloft_coverage* coverage, sonoloft_error* error);

/* How sure points of the last mesh are, e.g. its vertices. Of each: `measured`, 0..1, the share that slices had in the
 * surface there; `distance_mm` to the nearest place that the probe really showed. In on_mesh "the last mesh" is the one
 * at hand. Some us a point; waits for an update that runs. */
sonoloft_status sonoloft_scan_confidence(const sonoloft_scan* scan, const float* positions_mm, size_t count,
                                         float* measured, float* distance_mm, sonoloft_error* error);

#ifdef __cplusplus
}
#endif
