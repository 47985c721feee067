#pragma once
#include <Eigen/Geometry>
#include <chrono>
#include <optional>
#include <span>
#include <string>

#include "host/igtl/scene/label_surfaces.h"
#include "host/igtl/wire/message.h"

// surfaces, poses, states -> [MESSAGE BODIES] -> Message::body

namespace sonoloft::igtl {

/// POLYDATA: points, triangles and the label as a scalar of every point. Not one of every cell: the sizes that the
/// library reckons for those make its readers run over the end.
/// @pre at least one point, without which the library's readers go wrong
[[nodiscard]] Bytes polydata_body(const LabelSurface& surface);

/// TRANSFORM: the upper three rows, column by column.
[[nodiscard]] Bytes transform_body(const Eigen::Isometry3d& to_ras);
/// TDATA: one tracked tool with all six degrees of freedom. @pre a name of at most kNameLen bytes
[[nodiscard]] Bytes tdata_body(const std::string& name, const Eigen::Isometry3d& to_ras);
/// RTS_TDATA: done as asked.
[[nodiscard]] Bytes rts_tdata_body();
/// STATUS: all is well, and what there is to say.
[[nodiscard]] Bytes status_body(const std::string& text);

/// The least time between two TDATA that a STT_TDATA asks for; empty where its body is none.
[[nodiscard]] std::optional<std::chrono::milliseconds> tdata_interval(std::span<const std::byte> body);

}  // namespace sonoloft::igtl
