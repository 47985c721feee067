#include "host/igtl/wire/message_bodies.h"

#include <igtlStatusMessage.h>
#include <igtl_polydata.h>
#include <igtl_tdata.h>
#include <igtl_transform.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>

namespace sonoloft::igtl {
namespace {

std::array<igtl_float32, 12> columns(const Eigen::Isometry3d& pose) {
  std::array<igtl_float32, 12> values;
  const Eigen::Matrix<float, 3, 4> rows = pose.matrix().topRows<3>().cast<float>();
  std::copy(rows.data(), rows.data() + rows.size(), values.begin());  // Eigen's order is that of the columns, too
  return values;
}

template <class Struct>
Bytes bytes_of(const Struct& value) {
  Bytes bytes(sizeof value);
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

}  // namespace

Bytes polydata_body(const LabelSurface& surface) {
  assert(!surface.points.empty());
  std::vector<std::array<igtl_uint32, 4>> polygons;
  polygons.reserve(surface.triangles.size());
  for (const auto& [a, b, c] : surface.triangles) polygons.push_back({3, a, b, c});
  std::vector<std::array<float, 3>> points = surface.points;
  std::vector<igtl_float32> labels(points.size(), surface.label);
  char name[] = "Label";
  igtl_polydata_attribute attribute{IGTL_POLY_ATTR_TYPE_SCALAR, 1, static_cast<igtl_uint32>(labels.size()), name,
                                    labels.data()};
  igtl_polydata_info info;
  igtl_polydata_init_info(&info);
  info.header.npoints = static_cast<igtl_uint32>(points.size());
  info.header.npolygons = static_cast<igtl_uint32>(polygons.size());
  info.header.size_polygons = static_cast<igtl_uint32>(polygons.size() * sizeof polygons[0]);
  info.header.nattributes = 1;
  info.points = points.front().data();
  info.polygons = polygons.empty() ? nullptr : polygons.front().data();
  info.attributes = &attribute;
  Bytes body(igtl_polydata_get_size(&info, IGTL_TYPE_PREFIX_NONE));
  igtl_polydata_pack(&info, body.data(), IGTL_TYPE_PREFIX_NONE);
  return body;
}

Bytes transform_body(const Eigen::Isometry3d& to_ras) {
  auto values = columns(to_ras);
  igtl_transform_convert_byte_order(values.data());
  static_assert(sizeof values == IGTL_TRANSFORM_SIZE);
  return bytes_of(values);
}

Bytes tdata_body(const std::string& name, const Eigen::Isometry3d& to_ras) {
  assert(name.size() <= IGTL_TDATA_LEN_NAME);
  igtl_tdata_element element{};
  std::memcpy(element.name, name.data(), name.size());
  element.type = IGTL_TDATA_TYPE_6D;
  const auto values = columns(to_ras);
  std::memcpy(element.transform, values.data(), sizeof values);
  igtl_tdata_convert_byte_order(&element, 1);
  return bytes_of(element);
}

Bytes rts_tdata_body() {
  return Bytes(IGTL_RTS_TDATA_SIZE);
}

Bytes status_body(const std::string& text) {
  const auto message = ::igtl::StatusMessage::New();
  message->SetCode(::igtl::StatusMessage::STATUS_OK);
  message->SetErrorName("");
  message->SetStatusString(text.c_str());
  message->Pack();
  const auto* begin = static_cast<const std::byte*>(message->GetPackBodyPointer());
  return {begin, begin + message->GetPackBodySize()};
}

std::optional<std::chrono::milliseconds> tdata_interval(std::span<const std::byte> body) {
  igtl_stt_tdata asked;
  if (body.size() != sizeof asked) return std::nullopt;
  std::memcpy(&asked, body.data(), sizeof asked);
  igtl_stt_tdata_convert_byte_order(&asked);
  return std::chrono::milliseconds(std::max(0, asked.resolution));
}

}  // namespace sonoloft::igtl
