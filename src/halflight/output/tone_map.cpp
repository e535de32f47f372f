#include "halflight/output/tone_map.h"

namespace halflight {
namespace {

Rgb filmic(const Rgb& c) { return c * (2.51f * c + 0.03f) / (c * (2.43f * c + 0.59f) + 0.14f); }

// Sigmoid of AgX in display-encoded units: slope 2 through (0.6061, 0.5); b sets the bend, a makes
// the curve reach 0 at 0 and 1 at 1.
float agx_sigmoid(float v) {
  constexpr float kPivot = 20.f / 33.f;
  const bool toe = v < kPivot;
  const float b = toe ? 3.f : 3.25f;
  const float reach = toe ? kPivot : 1.f - kPivot;
  const float a = (std::pow(4.f * reach, b) - 1.f) / std::pow(reach, b);
  return 0.5f + 2.f * (v - kPivot) / std::pow(1.f + a * std::pow(std::abs(v - kPivot), b), 1.f / b);
}

// Colours move 20 % towards a weighted grey, each channel passes the sigmoid over a log2 range, and
// the grey is taken out again. The display encoding of AgX is a power of 2.2.
Rgb agx(const Rgb& c) {
  constexpr float kLowestEv = -12.47393f, kHighestEv = 4.026069f;
  const Rgb grey_weights(0.0424011f, 0.0784365f, 0.0791624f);  // sum 0.2
  const Rgb inset = 0.8f * c + glm::dot(grey_weights, c);
  Rgb curve;
  for (int k = 0; k < 3; ++k) {
    const float ev = std::log2(std::max(inset[k], 1e-10f));
    const float share = (ev - kLowestEv) / (kHighestEv - kLowestEv);
    curve[k] = agx_sigmoid(std::clamp(share, 0.f, 1.f));
  }
  const Rgb outset = (curve - glm::dot(grey_weights, curve)) / 0.8f;
  Rgb linear;
  for (int k = 0; k < 3; ++k) linear[k] = std::pow(std::max(0.f, outset[k]), 2.2f);
  return linear;
}

// https://github.com/KhronosGroup/ToneMapping, specification of PBR Neutral.
Rgb neutral(const Rgb& c) {
  constexpr float kFresnel = 0.04f, kStart = 0.8f - kFresnel, kDesaturation = 0.15f;
  const float x = min_component(c);
  const float toe = x <= 2.f * kFresnel ? x - x * x / (4.f * kFresnel) : kFresnel;
  const Rgb shifted = c - toe;
  const float peak = max_component(shifted);
  if (peak <= kStart) return shifted;
  const float new_peak = 1.f - (1.f - kStart) * (1.f - kStart) / (peak + 1.f - 2.f * kStart);
  const float keep = 1.f / (kDesaturation * (peak - new_peak) + 1.f);
  return shifted * (new_peak / peak * keep) + Rgb(new_peak * (1.f - keep));
}

Rgb curve(ToneMap map, const Rgb& c) {
  switch (map) {
    case ToneMap::filmic:
      return filmic(c);
    case ToneMap::agx:
      return agx(c);
    case ToneMap::neutral:
      return neutral(c);
    case ToneMap::none:
      break;
  }
  return c;
}

}  // namespace

Rgb tone_mapped(ToneMap map, const Rgb& exposed) {
  return glm::clamp(curve(map, glm::max(exposed, Rgb(0.f))), Rgb(0.f), Rgb(1.f));
}

Image developed(const Image& radiance, float ev, ToneMap map) {
  const float scale = std::exp2(ev);
  Image out = radiance;
  for (Rgb& c : out.pixels) c = tone_mapped(map, scale * c);
  return out;
}

float automatic_ev(const Image& radiance) {
  constexpr double kMiddleGrey = 0.18;
  double sum = 0.0;
  std::size_t count = 0;
  for (const Rgb& c : radiance.pixels) {
    const float y = luminance(c);
    if (!(y > 0.f) || !std::isfinite(y)) continue;
    sum += std::log2(y);
    ++count;
  }
  if (count == 0) return 0.f;
  return static_cast<float>(std::log2(kMiddleGrey) - sum / static_cast<double>(count));
}

}  // namespace halflight
