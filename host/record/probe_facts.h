#pragma once
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "protocol/command.h"

// replies of a probe -> [PROBE FACTS] -> metadata of a recording

namespace sonoloft::record {

/// What a probe says of itself before it streams.
class ProbeFacts {
 public:
  /// Takes an exchange that went well; only some are of interest.
  void take(const protocol::RequestView& request, const protocol::ReplyView& reply);

  /// For people, in words: versions, serial number, calibration. Empty before a probe said both.
  [[nodiscard]] std::map<std::string, std::string> text() const;

 private:
  std::optional<protocol::InfoReply> info_;
  std::optional<protocol::CalibrationMessage> calibration_;
};

}  // namespace sonoloft::record
