// The background of a hand-held sweep of 1,000 slices, slice by slice, and what a question to it costs.
//   bench_background
#include <ctime>

#include "core/background/background.h"
#include "tests/bench/support/figures.h"
#include "tests/support/view_slices.h"

namespace {

using namespace sonoloft;
using namespace sonoloft::bench;

constexpr int kSlices = 1000;
const Eigen::AlignedBox3d kBox(Eigen::Vector3d::Constant(-130), Eigen::Vector3d::Constant(130));

/// Processor time, ms: other programs may be running.
template <class Body>
double cpu_ms(const Body& body) {
  const std::clock_t start = std::clock();
  body();
  return 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

std::vector<Section> sweep_of(const std::vector<test::Ball>& balls) {
  std::vector<Section> sections;
  for (const Eigen::Isometry3d& frame : test::hand_sweep(kSlices, 1))
    sections.push_back(test::checked_section(test::slice_of_balls(frame, balls, test::sector_view())));
  return sections;
}

std::vector<Eigen::Vector3d> lattice_points(int edge, double spacing_mm) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < edge * edge * edge; ++i)
    points.push_back(spacing_mm * Eigen::Vector3d(i % edge, i / edge % edge, i / edge / edge));
  return points;
}

void questions(const Background& background, double spacing_mm) {
  constexpr int kRuns = 200;
  for (const int edge : {4, 8, 16}) {
    const auto points = lattice_points(edge, 1.0);
    PointShares shares;
    std::vector<float> distance, weight;
    const auto ns_a_point = [&](const auto& ask) {
      return 1e6 * cpu_ms([&] {
               for (int i = 0; i < kRuns; ++i) ask();
             }) /
             (kRuns * static_cast<double>(points.size()));
    };
    const double share_ns = ns_a_point([&] { background.shares(points, shares); });
    const double local_ns = ns_a_point([&] { background.local(points, weight, shares); });
    const double distance_ns = ns_a_point([&] { background.distance(points, distance); });
    char words[200];
    std::snprintf(words, sizeof words,
                  "background, H %.1f, %zu points: %.1f ns a point and label, local %.1f, distance %.0f ns a point",
                  spacing_mm, points.size(), share_ns / static_cast<double>(shares.labels.size()),
                  local_ns / static_cast<double>(shares.labels.size()), distance_ns);
    emit({{"bench", "background_questions"},
          {"spacing_mm", spacing_mm},
          {"points", points.size()},
          {"share_ns", share_ns},
          {"local_ns", local_ns},
          {"distance_ns", distance_ns},
          {"labels", shares.labels.size()}},
         words);
  }
}

void sweep(const std::string& name, const std::vector<Section>& sections, double spacing_mm) {
  Background background(kBox, spacing_mm);
  std::vector<double> add, update, changed;
  for (const Section& section : sections) {
    add.push_back(cpu_ms([&] { background.add(section); }));
    std::size_t cells = 0;
    update.push_back(cpu_ms([&] {
      for (const BackgroundChange& change : background.update(1)) cells += change.changed.count();
    }));
    changed.push_back(static_cast<double>(cells));
  }
  Background whole(kBox, spacing_mm);
  for (const Section& section : sections) whole.add(section);
  const double whole_ms = cpu_ms([&] { static_cast<void>(whole.update(1)); });
  const auto mean = [](const std::vector<double>& v, std::size_t first, std::size_t count) {
    double sum = 0;
    for (std::size_t i = first; i < first + count; ++i) sum += v[i];
    return sum / static_cast<double>(count);
  };
  char words[400];
  std::snprintf(
      words, sizeof words,
      "background, %s, H %.1f: add %.2f ms; update mean %.2f, p95 %.2f, slices 50-150 %.2f, last 100 %.2f ms; cells "
      "changed %.0f; all at once %.0f ms; %.1f MiB",
      name.c_str(), spacing_mm, mean(add, 0, add.size()), mean(update, 0, update.size()), quantile(update, 0.95),
      mean(update, 50, 100), mean(update, update.size() - 100, 100), mean(changed, 0, changed.size()), whole_ms,
      static_cast<double>(background.memory_bytes()) / (1 << 20));
  emit({{"bench", "background"},
        {"name", name},
        {"spacing_mm", spacing_mm},
        {"slices", sections.size()},
        {"add_ms", mean(add, 0, add.size())},
        {"update_ms", mean(update, 0, update.size())},
        {"update_p95_ms", quantile(update, 0.95)},
        {"update_50_150_ms", mean(update, 50, 100)},
        {"update_last_100_ms", mean(update, update.size() - 100, 100)},
        {"cells_changed", mean(changed, 0, changed.size())},
        {"all_at_once_ms", whole_ms},
        {"memory_bytes", background.memory_bytes()}},
       words);
  questions(background, spacing_mm);
}

/// As many balls of `labels` labels as the body has room for, side by side.
std::vector<test::Ball> many_labels(int labels) {
  std::vector<test::Ball> balls;
  for (int i = 0; i < 64; ++i)
    balls.push_back(
        {25.0 * Eigen::Vector3d(i % 4 - 1.5, i / 4 % 4 - 1.0, i / 16 - 1.5), 9, static_cast<Label>(1 + i % labels)});
  return balls;
}

}  // namespace

int main() {
  const std::vector<Section> body = sweep_of(test::body());
  for (const double spacing_mm : {5.0, 2.5}) sweep("3 labels", body, spacing_mm);
  sweep("64 balls of 2 labels", sweep_of(many_labels(1)), 2.5);
  sweep("64 balls of 33 labels", sweep_of(many_labels(32)), 2.5);
}
