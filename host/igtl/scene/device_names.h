#pragma once
#include <map>
#include <string>

#include "core/io/labels/label_table.h"
#include "core/slice/label.h"

namespace sonoloft::igtl {

/// The device names of labels: what the table calls them. A name that is too long for the wire, or is another label's
/// already, is cut (between characters of UTF-8) and the label's number put behind it.
class DeviceNames {
 public:
  explicit DeviceNames(LabelTable labels) : labels_(std::move(labels)) {}

  /// The same at every call; no other label's; 1 to kNameLen bytes.
  [[nodiscard]] const std::string& of(Label label);

 private:
  LabelTable labels_;
  std::map<std::string, Label> given_;
  std::map<Label, std::string> names_;
};

}  // namespace sonoloft::igtl
