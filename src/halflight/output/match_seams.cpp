#include "halflight/output/match_seams.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>

namespace halflight {
namespace {

constexpr float kSamplesPerTexel = 2.f;  // along an edge
constexpr double kStayInside = 0.1, kStayOutside = 0.01;
constexpr double kAccuracy = 1e-5;
constexpr int kMostRounds = 500;

// Bilinear filtering at one place.
struct Footprint {
  std::array<std::uint32_t, 4> texels{};
  std::array<float, 4> weights{};
};

Footprint footprint_at(Vec2 texel_coordinates, int size) {
  const Vec2 from_centre = texel_coordinates - 0.5f, low = glm::floor(from_centre);
  const Vec2 share = from_centre - low;
  Footprint f;
  for (std::size_t k = 0; k < 4; ++k) {
    const bool right = k % 2 != 0, down = k / 2 != 0;
    const int x = std::clamp(static_cast<int>(low.x) + (right ? 1 : 0), 0, size - 1);
    const int y = std::clamp(static_cast<int>(low.y) + (down ? 1 : 0), 0, size - 1);
    f.texels[k] = static_cast<std::uint32_t>(y * size + x);
    f.weights[k] = (right ? share.x : 1.f - share.x) * (down ? share.y : 1.f - share.y);
  }
  return f;
}

struct SeamSample {
  Footprint sides[2];
};

std::vector<SeamSample> sample_seams(const LightmapCharts& charts, const LightmapLayout& layout) {
  std::vector<SeamSample> samples;
  for (const ChartSeam& seam : charts.seams) {
    std::array<std::array<Vec2, 2>, 2> ends{};  // by chart
    float length = 0.f;
    for (std::size_t c = 0; c < 2; ++c) {
      for (std::size_t k = 0; k < 2; ++k)
        ends[c][k] = layout.to_texels(charts, seam.charts[c], seam.ends[k]);
      length = std::max(length, glm::distance(ends[c][0], ends[c][1]));
    }
    const int count = 1 + static_cast<int>(kSamplesPerTexel * length);
    for (int i = 0; i < count; ++i) {
      const float at = (static_cast<float>(i) + 0.5f) / static_cast<float>(count);
      SeamSample& s = samples.emplace_back();
      for (std::size_t c = 0; c < 2; ++c)
        s.sides[c] = footprint_at(glm::mix(ends[c][0], ends[c][1], at), layout.size);
    }
  }
  return samples;
}

Rgb filtered(const Image& image, const Footprint& f) {
  Rgb sum(0.f);
  for (std::size_t k = 0; k < 4; ++k) sum += f.weights[k] * image.pixels[f.texels[k]];
  return sum;
}

}  // namespace

float seam_difference(const Image& lightmap, const LightmapCharts& charts,
                      const LightmapLayout& layout) {
  const std::vector<SeamSample> samples = sample_seams(charts, layout);
  double sum = 0.0;
  for (const SeamSample& s : samples) {
    const Rgb d = filtered(lightmap, s.sides[0]) - filtered(lightmap, s.sides[1]);
    sum += static_cast<double>(glm::dot(d, d)) / 3.0;
  }
  return static_cast<float>(
      std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, samples.size()))));
}

void match_seams(Image& lightmap, const LightmapCharts& charts, const LightmapLayout& layout,
                 const std::vector<ChartTexel>& texels) {
  const std::vector<SeamSample> samples = sample_seams(charts, layout);
  if (samples.empty()) return;
  constexpr std::uint32_t kFixed = ~0u;
  std::vector<std::uint32_t> unknown(lightmap.pixels.size(), kFixed);
  std::vector<std::uint32_t> moved;  // texel of each unknown
  for (const SeamSample& s : samples)
    for (const Footprint& f : s.sides)
      for (const std::uint32_t t : f.texels)
        if (unknown[t] == kFixed) {
          unknown[t] = static_cast<std::uint32_t>(moved.size());
          moved.push_back(t);
        }
  std::vector<double> stay(moved.size(), kStayOutside);
  for (const ChartTexel& t : texels)
    if (t.inside && unknown[t.index] != kFixed) stay[unknown[t.index]] = kStayInside;

  // One row for each sample, then one for each unknown.
  const auto columns = static_cast<int>(moved.size());
  const auto rows = static_cast<int>(samples.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(8 * samples.size() + moved.size());
  for (int i = 0; i < rows; ++i)
    for (std::size_t c = 0; c < 2; ++c)
      for (std::size_t k = 0; k < 4; ++k) {
        const Footprint& f = samples[static_cast<std::size_t>(i)].sides[c];
        const auto weight = static_cast<double>(c == 0 ? f.weights[k] : -f.weights[k]);
        entries.emplace_back(i, static_cast<int>(unknown[f.texels[k]]), weight);
      }
  for (int i = 0; i < columns; ++i)
    entries.emplace_back(rows + i, i, stay[static_cast<std::size_t>(i)]);
  Eigen::SparseMatrix<double> matrix(rows + columns, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  Eigen::LeastSquaresConjugateGradient<Eigen::SparseMatrix<double>> solver;
  solver.setTolerance(kAccuracy);
  solver.setMaxIterations(kMostRounds);
  solver.compute(matrix);

  Eigen::VectorXd wanted = Eigen::VectorXd::Zero(rows + columns), before(columns);
  for (int channel = 0; channel < 3; ++channel) {
    for (int i = 0; i < columns; ++i) {
      before[i] = static_cast<double>(lightmap.pixels[moved[static_cast<std::size_t>(i)]][channel]);
      wanted[rows + i] = stay[static_cast<std::size_t>(i)] * before[i];
    }
    const Eigen::VectorXd after = solver.solveWithGuess(wanted, before);
    for (int i = 0; i < columns; ++i)
      lightmap.pixels[moved[static_cast<std::size_t>(i)]][channel] =
          std::max(0.f, static_cast<float>(after[i]));
  }
}

}  // namespace halflight
