#include "halflight/view/light_frames.h"

#include <algorithm>
#include <cmath>

#include "halflight/base/parallel.h"
#include "halflight/view/packet.h"
#include "halflight/view/shared_exponent.h"

namespace halflight {
namespace {

constexpr float kMostOff = 16.f;  // from the mean, before another scale is taken

float scale_for(std::span<const Rgb> irradiance, float before) {
  double sum = 0.0;
  for (const Rgb& e : irradiance) sum += static_cast<double>(average(e));
  const auto mean =
      static_cast<float>(sum / static_cast<double>(std::max<std::size_t>(1, irradiance.size())));
  if (!(mean > 0.f) || !std::isfinite(mean)) return before > 0.f ? before : 1.f;
  if (before > 0.f && mean < kMostOff * before && mean * kMostOff > before) return before;
  return std::exp2(std::round(std::log2(mean)));
}

}  // namespace

void LightFrames::begin(std::uint32_t epoch) {
  auto next = std::make_shared<Frame>();
  const std::lock_guard lock(mutex_);
  next->epoch = epoch;
  next->version = frame_->version;
  next->scale = frame_->scale;
  frame_ = std::move(next);
}

std::uint64_t LightFrames::version() const {
  const std::lock_guard lock(mutex_);
  return frame_->version;
}

std::uint64_t LightFrames::add(std::uint32_t epoch, std::span<const Rgb> irradiance,
                               float exposure) {
  std::shared_ptr<const Frame> before;
  {
    const std::lock_guard lock(mutex_);
    before = frame_;
  }
  auto next = std::make_shared<Frame>();
  next->epoch = epoch;
  next->has_light = true;
  next->version = before->version + 1;
  next->exposure = exposure;
  next->scale = scale_for(irradiance, before->scale);
  next->light.resize(irradiance.size());
  parallel_for(irradiance.size(), 4096,
               [&](std::size_t i) { next->light[i] = pack_rgb9e5(irradiance[i] / next->scale); });
  const bool comparable = before->epoch == epoch && before->scale == next->scale &&
                          before->light.size() == next->light.size();
  next->last_changes.assign((irradiance.size() + kBlock - 1) / kBlock, next->version);
  for (std::size_t b = 0; comparable && b < next->last_changes.size(); ++b) {
    const auto first = static_cast<std::ptrdiff_t>(b * kBlock);
    const auto last = static_cast<std::ptrdiff_t>(std::min(irradiance.size(), (b + 1) * kBlock));
    if (std::equal(next->light.begin() + first, next->light.begin() + last,
                   before->light.begin() + first))
      next->last_changes[b] = before->last_changes[b];
  }
  const std::lock_guard lock(mutex_);
  frame_ = std::move(next);
  return frame_->version;
}

std::string LightFrames::since(std::uint32_t epoch, std::uint64_t version) const {
  std::shared_ptr<const Frame> frame;
  {
    const std::lock_guard lock(mutex_);
    frame = frame_;
  }
  if (!frame->has_light) return {};
  const bool all = epoch != frame->epoch;
  std::vector<std::uint32_t> ranges, light;  // first vertex and count of each range
  for (std::size_t b = 0; b < frame->last_changes.size(); ++b) {
    if (!all && frame->last_changes[b] <= version) continue;
    const std::size_t first = b * kBlock, last = std::min(frame->light.size(), first + kBlock);
    if (!ranges.empty() && ranges[ranges.size() - 2] + ranges.back() == first)
      ranges.back() += static_cast<std::uint32_t>(last - first);
    else
      ranges.insert(ranges.end(),
                    {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(last - first)});
    light.insert(light.end(), frame->light.begin() + static_cast<std::ptrdiff_t>(first),
                 frame->light.begin() + static_cast<std::ptrdiff_t>(last));
  }
  Packet packet;
  packet.header["epoch"] = frame->epoch;
  packet.header["version"] = frame->version;
  packet.header["scale"] = frame->scale;
  packet.header["exposure"] = frame->exposure;
  packet.add<std::uint32_t>("ranges", "u32", ranges);
  packet.add<std::uint32_t>("light", "u32", light);
  return packet.bytes();
}

}  // namespace halflight
