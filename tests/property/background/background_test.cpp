#include "core/background/background.h"

#include <doctest/doctest.h>

#include <map>
#include <random>
#include <tuple>

#include "tests/support/view_slices.h"

using namespace sonoloft;

namespace {

const Eigen::AlignedBox3d kBox(Eigen::Vector3d(-60, -55, -50), Eigen::Vector3d(60, 50, 65));
constexpr double kSpacing = 4;

/// Planes of all directions, most of them seen through a window, some with a small shadow.
std::vector<Section> random_slices(unsigned seed, int count) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const std::vector<test::Ball> balls{{{-15, 0, 0}, 20, 1}, {{18, 5, -5}, 12, 2}, {{-15, 3, 2}, 8, 3}};
  std::vector<Section> sections;
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d middle(20 * uniform(rng), 20 * uniform(rng));
    const Eigen::Isometry3d frame = test::random_frame(rng, 20);
    TrackedSlice slice =
        i % 4 == 3 ? test::slice_of_balls(frame, balls) : test::slice_of_balls(frame, balls, test::ring(middle, 30, 5));
    if (i % 3 == 0) test::add_contour(slice, test::ring(middle / 2, 5, 12), kUnknown);
    sections.push_back(test::checked_section(slice));
  }
  return sections;
}

std::vector<Eigen::Vector3d> points_everywhere() {
  std::vector<Eigen::Vector3d> points;
  for (int z = -56; z <= 70; z += 4)
    for (int y = -60; y <= 56; y += 4)
      for (int x = -66; x <= 66; x += 4) points.push_back(Eigen::Vector3d(x, y, z) * 1.01);
  return points;
}

/// All that can be asked, to be compared bit by bit.
struct Answers {
  PointShares shares, local;
  std::vector<float> weight, distance;
  std::vector<std::tuple<int, int, int, BackgroundMask>> seeds;

  explicit Answers(const Background& background) {
    static const std::vector<Eigen::Vector3d> points = points_everywhere();
    background.shares(points, shares);
    background.local(points, weight, local);
    background.distance(points, distance);
    seeds = seeds_of(background.seeds());
  }
  static std::vector<std::tuple<int, int, int, BackgroundMask>> seeds_of(const std::vector<BackgroundChange>& changes) {
    std::vector<std::tuple<int, int, int, BackgroundMask>> result;
    for (const BackgroundChange& c : changes) result.emplace_back(c.brick.z(), c.brick.y(), c.brick.x(), c.begun);
    return result;
  }
};

bool same(const Answers& a, const Answers& b) {
  return a.shares.labels == b.shares.labels && a.shares.share == b.shares.share && a.local.labels == b.local.labels &&
         a.local.share == b.local.share && a.weight == b.weight && a.distance == b.distance &&
         std::equal(a.seeds.begin(), a.seeds.end(), b.seeds.begin(), b.seeds.end(),
                    [](const auto& s, const auto& t) { return s == t; });
}

Answers at_once(const std::vector<Section>& sections, int threads = 1) {
  Background background(kBox, kSpacing);
  for (const Section& section : sections) background.add(section);
  background.update(threads);
  return Answers(background);
}

}  // namespace

TEST_CASE("background: neither order nor grouping into updates nor threads change a bit") {
  const std::vector<Section> sections = random_slices(1, 24);
  const Answers whole = at_once(sections);
  CHECK(whole.shares.labels == std::vector<Label>{0, 1, 2, 3});
  CHECK(same(whole, at_once({sections.rbegin(), sections.rend()}, 2)));
  for (const int group : {1, 2, 7})
    for (const int threads : {1, 2}) {
      Background background(kBox, kSpacing);
      for (std::size_t i = 0; i < sections.size(); ++i) {
        background.add(sections[(5 * i) % sections.size()]);
        if (static_cast<int>(i) % group == group - 1) background.update(threads);
      }
      background.update(threads);
      CHECK(same(whole, Answers(background)));
    }
}

TEST_CASE("background: slices taken back leave no trace") {
  const std::vector<Section> sections = random_slices(2, 20);
  const std::vector<Section> kept(sections.begin(), sections.begin() + 10);
  Background background(kBox, kSpacing);
  for (const Section& section : sections) background.add(section);
  background.update(2);
  for (std::size_t i = 19; i >= 10; --i) {
    background.remove(sections[i]);
    if (i % 3 == 0) background.update(1);
  }
  background.update(1);
  CHECK(same(at_once(kept), Answers(background)));
  for (const Section& section : kept) background.remove(section);
  background.update(1);
  CHECK(same(at_once({}), Answers(background)));
  CHECK(background.labels_near(kBox) == std::vector<Label>{kOutside});
  CHECK(background.memory_bytes() == 0);
}

TEST_CASE("background: an update names every cell in which shares changed, and all seeds that came and went") {
  Background background(kBox, kSpacing);
  std::map<std::tuple<int, int, int>, BackgroundMask> seeds;
  const std::vector<Eigen::Vector3d> points = points_everywhere();
  PointShares before, after;
  background.shares(points, before);
  std::size_t named = 0, moved = 0;
  for (const Section& section : random_slices(3, 12)) {
    background.add(section);
    std::vector<Eigen::AlignedBox3d> cells;
    for (const BackgroundChange& change : background.update(1)) {
      BackgroundMask& held = seeds[{change.brick.z(), change.brick.y(), change.brick.x()}];
      CHECK((held & change.begun).none());
      CHECK((held & change.ended) == change.ended);
      held = (held | change.begun) & ~change.ended;
      for (int bit = 0; bit < 512; ++bit)
        if (change.changed.test(static_cast<std::size_t>(bit))) cells.push_back(background.cell_box(change.brick, bit));
    }
    background.shares(points, after);
    for (std::size_t p = 0; p < points.size(); p += 7) {
      bool changed = false;
      for (std::size_t l = 0; l < after.labels.size(); ++l) {
        const auto it = std::find(before.labels.begin(), before.labels.end(), after.labels[l]);
        const auto at = static_cast<std::size_t>(it - before.labels.begin());
        const float old = it == before.labels.end() ? 0.0f : before.share[at * points.size() + p];
        changed = changed || old != after.share[l * points.size() + p];
      }
      if (!changed) continue;
      ++moved;
      named += std::any_of(cells.begin(), cells.end(), [&](const auto& box) { return box.contains(points[p]); });
    }
    std::swap(before, after);
  }
  MESSAGE("points with new shares: ", moved);
  CHECK(moved > 500);
  CHECK(named == moved);
  std::erase_if(seeds, [](const auto& entry) { return entry.second.none(); });
  const auto held = Answers::seeds_of(background.seeds());
  CHECK(held.size() == seeds.size());
  for (const auto& [z, y, x, mask] : held) CHECK(seeds[{z, y, x}] == mask);
}

TEST_CASE("background: shares of every point sum to 1, and none is negative") {
  Background background(kBox, kSpacing);
  for (const Section& section : random_slices(4, 30)) background.add(section);
  background.update(1);
  const Answers answers(background);
  for (const PointShares* shares : {&answers.shares, &answers.local}) {
    const std::size_t points = answers.weight.size();
    float worst_sum = 0, least = 1;
    for (std::size_t p = 0; p < points; ++p) {
      float sum = 0;
      for (std::size_t l = 0; l < shares->labels.size(); ++l) {
        sum += shares->share[l * points + p];
        least = std::min(least, shares->share[l * points + p]);
      }
      worst_sum = std::max(worst_sum, std::abs(sum - 1));
    }
    MESSAGE("sum off by at most ", worst_sum, ", least share ", least);
    CHECK(worst_sum < 1e-6f);
    CHECK(least > -1e-6f);
  }
}

TEST_CASE("background: the distance to what was seen is right to 1.2 spacings") {
  std::mt19937 rng(5);
  const std::vector<Eigen::Vector3d> points = points_everywhere();
  double low = 0, high = 0;
  for (int i = 0; i < 20; ++i) {
    Background background(kBox, kSpacing);
    const Eigen::Isometry3d frame = test::random_frame(rng, 40);
    background.add(test::checked_section(test::slice_of_balls(frame, {})));
    std::vector<float> distance;
    background.distance(points, distance);
    for (std::size_t p = 0; p < points.size(); ++p) {
      if (kBox.exteriorDistance(points[p]) > 0) continue;
      const Eigen::Vector3d local = frame.inverse(Eigen::Isometry) * points[p];
      const Eigen::Vector3d foot = frame * Eigen::Vector3d(local.x(), local.y(), 0);
      const double truth = std::abs(local.z());
      // Where the foot lies beyond the box, nothing was seen there.
      if (kBox.exteriorDistance(foot) > 0 || truth > (kBackgroundReach - 1) * kSpacing) continue;
      low = std::min(low, (distance[p] - truth) / kSpacing);
      high = std::max(high, (distance[p] - truth) / kSpacing);
    }
  }
  MESSAGE("distance off by ", low, " to ", high, " spacings");
  CHECK(low > -1.2);
  CHECK(high < 1.2);
}
