#include "halflight/view/light_frames.h"

#include <algorithm>

#include "halflight/base/parallel.h"
#include "halflight/view/packet.h"
#include "halflight/view/shared_exponent.h"

namespace halflight {

void LightFrames::begin(std::uint32_t epoch) {
  auto next = std::make_shared<Frame>();
  const std::lock_guard lock(mutex_);
  next->epoch = epoch;
  next->version = frame_->version;
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
  next->version = before->version + 1;
  next->exposure = exposure;
  next->light.resize(irradiance.size());
  parallel_for(irradiance.size(), 4096,
               [&](std::size_t i) { next->light[i] = pack_rgb9e5(irradiance[i]); });
  const bool comparable = before->epoch == epoch && before->light.size() == next->light.size();
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
  if (frame->light.empty()) return {};
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
  packet.header["exposure"] = frame->exposure;
  packet.add<std::uint32_t>("ranges", "u32", ranges);
  packet.add<std::uint32_t>("light", "u32", light);
  return packet.bytes();
}

}  // namespace halflight
