#include "host/apps/tool/common_options.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <thread>

namespace sonoloft::tool {

CLI::Validator finite(double low, double high) {
  return CLI::Validator(
      [low, high](std::string& text) -> std::string {
        double value = 0;
        if (CLI::detail::lexical_cast(text, value) && value >= low && value <= high) return {};
        std::ostringstream message;
        message << "'" << text << "' is not a number from " << low << " to " << high;
        return message.str();
      },
      {});
}

CLI::Validator ends_in(const std::string& suffixes) {
  return CLI::Validator(
      [suffixes](std::string& path) -> std::string {
        for (const std::string& suffix : CLI::detail::split(suffixes, ','))
          if (path.size() > suffix.size() && path.ends_with(suffix)) return {};
        return "'" + path + "' does not end in one of " + suffixes;
      },
      {});
}

void add_resolution(CLI::App& verb, Resolution& resolution) {
  auto* depth = verb.add_option("--depth", resolution.depth,
                                "Finest cells: the object's longest side is about 2^depth of them long")
                    ->check(CLI::Range(5, 10))
                    ->capture_default_str();
  verb.add_option("--resolution-mm", resolution.spacing_mm, "Finest cells: their edge in mm, instead of --depth")
      ->check(finite(1e-6, 1e6))
      ->excludes(depth);
}

Result<double> spacing(const Resolution& resolution, double longest_side_mm) {
  constexpr double kMaxCells = 4096, kMinCells = 4;
  if (!resolution.spacing_mm) return 1.1 * longest_side_mm / std::exp2(resolution.depth);
  const double cells = longest_side_mm / *resolution.spacing_mm;
  if (cells >= kMinCells && cells <= kMaxCells) return *resolution.spacing_mm;
  std::ostringstream message;
  message << "--resolution-mm " << *resolution.spacing_mm << " does not fit an object of " << longest_side_mm
          << " mm: give " << longest_side_mm / kMaxCells << " to " << longest_side_mm / kMinCells;
  return fail(ErrorCode::invalid_argument, message.str());
}

void add_field(CLI::App& verb, FieldMethod& field) {
  verb.add_option_function<std::string>(
          "--field",
          [&field](const std::string& name) { field = name == "step" ? FieldMethod::step : FieldMethod::smooth; },
          "What lies between slices: smooth (contours move by slope and curvature) or step (as published: the surface "
          "leaves every slice at a right angle)")
      ->check(CLI::IsMember({"smooth", "step"}))
      ->default_str(field == FieldMethod::smooth ? "smooth" : "step");
}

void add_admission(CLI::App& verb, Admission& admission) {
  verb.add_option_function<std::string>(
          "--admission",
          [&admission](const std::string& name) {
            admission = name == "news" ? Admission::news : Admission::everything;
          },
          "Where slices cut: everything (each is interpolated) or news (where they say what is not known yet)")
      ->check(CLI::IsMember({"everything", "news"}))
      ->default_str(admission == Admission::news ? "news" : "everything");
}

void add_threads(CLI::App& verb, int& threads) {
  threads = static_cast<int>(std::clamp(std::thread::hardware_concurrency(), 1u, 256u));
  verb.add_option("--threads", threads, "Threads to compute with; the result does not depend on it")
      ->check(CLI::Range(1, 256))
      ->capture_default_str();
}

void add_compute(CLI::App& verb, Compute& compute) {
  add_threads(verb, compute.threads);
  static const std::map<std::string, DeviceChoice> kChoices = {
      {"auto", DeviceChoice::automatic}, {"opencl", DeviceChoice::opencl}, {"cpu", DeviceChoice::cpu}};
  verb.add_option_function<std::string>(
          "--device", [&compute](const std::string& name) { compute.device = kChoices.at(name); },
          "Where the field is evaluated: auto (OpenCL on a graphics device, else cpu), opencl, cpu")
      ->check(CLI::IsMember({"auto", "opencl", "cpu"}))
      ->default_str("auto");
}

void add_labels(CLI::App& verb, std::optional<std::filesystem::path>& labels) {
  verb.add_option("--labels", labels, "Names and colours of the labels: a colour table of 3D Slicer (.ctbl)");
}

Result<LabelTable> read_labels(const std::optional<std::filesystem::path>& labels) {
  return labels ? read_label_table(*labels) : LabelTable();
}

void add_report(CLI::App& verb, std::optional<std::filesystem::path>& report) {
  verb.add_option("--report", report, "Write the figures to this JSON file");
}

}  // namespace sonoloft::tool
