#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>

#include "core/field/device_choice.h"
#include "core/io/labels/label_table.h"
#include "core/reconstructor/reconstructor.h"
#include "core/slice/result.h"

namespace sonoloft::tool {

/// Options that several verbs have. What is in them before they are added is the default that --help states.
struct Resolution {
  int depth = 8;                     ///< the longest side of the object is 2^depth / 1.1 finest cells long
  std::optional<double> spacing_mm;  ///< instead of the depth
};
void add_resolution(CLI::App& verb, Resolution& resolution);
/// Edge of a finest cell for an object of this size.
/// @error invalid_argument (more than 4096 cells along the object, or less than 4)
[[nodiscard]] Result<double> spacing(const Resolution& resolution, double longest_side_mm);

struct Compute {
  int threads;  ///< add_compute() sets one for every core
  DeviceChoice device = DeviceChoice::automatic;
};
void add_compute(CLI::App& verb, Compute& compute);

/// --field; its value is the default that --help states.
void add_field(CLI::App& verb, FieldMethod& field);

/// @param admission  its value is the default that --help states
void add_admission(CLI::App& verb, Admission& admission);

void add_threads(CLI::App& verb, int& threads);
/// --labels; without it the table is empty.
void add_labels(CLI::App& verb, std::optional<std::filesystem::path>& labels);
/// @error those of read_label_table()
[[nodiscard]] Result<LabelTable> read_labels(const std::optional<std::filesystem::path>& labels);

void add_report(CLI::App& verb, std::optional<std::filesystem::path>& report);

/// Accepts finite numbers of [low, high].
[[nodiscard]] CLI::Validator finite(double low, double high);
/// Accepts paths that end in one of the suffixes, which are given in lower case with their dots, apart by commas.
[[nodiscard]] CLI::Validator ends_in(const std::string& suffixes);

}  // namespace sonoloft::tool
