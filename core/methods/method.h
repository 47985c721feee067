#pragma once
// slices -> [METHOD] -> surfaces: what the published methods that are here to be compared with have in common
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/mesh/mesh.h"
#include "core/slice/result.h"
#include "core/slice/tracked_slice.h"

namespace sonoloft {

/// Something about a method that its caller may choose.
struct MethodOption {
  std::string_view name, help, standard;
  std::vector<std::string_view> values;  ///< all that it may be; empty: the method itself judges
};

/// The value of every option of a method.
using MethodSettings = std::map<std::string, std::string, std::less<>>;

struct MethodInput {
  std::span<const TrackedSlice> slices;  ///< in any order
  double spacing_mm = 0;                 ///< edge of a finest cell: what is finer is not drawn; > 0
  int threads = 1;                       ///< >= 1; the result does not depend on it
  MethodSettings settings;
};

struct MethodSurfaces {
  IndexedMesh mesh;                ///< closed around every label; frame: reference, mm
  std::vector<std::string> notes;  ///< one line each on what the method could not do as it should
};

/// A published method of reconstruction: all slices at once, no live path. Each has a room of its own with a typed
/// interface; this is how the tool, the tests and the benchmarks call any of them.
struct Method {
  std::string_view name;
  std::string_view takes;  ///< one line: which slices, how many labels
  std::vector<MethodOption> options;
  /// @error of slices that it cannot take: invalid_argument, and the message names what it can take and what else to
  /// use;
  ///        empty_input, too_large; those of make_section()
  Result<MethodSurfaces> (*run)(const MethodInput& input);
};

}  // namespace sonoloft
