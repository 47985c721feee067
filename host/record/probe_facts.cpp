#include "host/record/probe_facts.h"

#include <sonoloft/version.h>

#include <cstring>
#include <sstream>

namespace sonoloft::record {
namespace {

template <std::size_t N>
std::string text_of(const char (&field)[N]) {
  return std::string(field, strnlen(field, N));
}

std::string rows(const double (&matrix)[12]) {
  std::ostringstream text;
  text.precision(17);
  for (std::size_t i = 0; i < 12; ++i) text << matrix[i] << (i % 4 == 3 ? "; " : " ");
  std::string all = text.str();
  return all.substr(0, all.size() - 2);
}

}  // namespace

void ProbeFacts::take(const protocol::RequestView& request, const protocol::ReplyView& reply) {
  protocol::InfoReply info;
  protocol::CalibrationMessage calibration;
  if (request.command == protocol::Command::get_info && protocol::read_payload(reply.payload, info)) info_ = info;
  if (request.command == protocol::Command::get_calibration && protocol::read_payload(reply.payload, calibration))
    calibration_ = calibration;
}

std::map<std::string, std::string> ProbeFacts::text() const {
  if (!info_ || !calibration_) return {};
  return {{"host", "SonoLoft " SONOLOFT_VERSION},
          {"firmware", text_of(info_->firmware_version)},
          {"serial", text_of(info_->serial)},
          {"protocol", std::to_string(info_->major) + "." + std::to_string(info_->minor)},
          {"calibration_id", std::to_string(calibration_->id)},
          {"image_to_probe", rows(calibration_->image_to_probe)}};
}

}  // namespace sonoloft::record
