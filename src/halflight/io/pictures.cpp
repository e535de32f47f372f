#include "halflight/io/pictures.h"

#include <algorithm>

#include "halflight/base/parallel.h"
#include "halflight/io/image_reader.h"
#include "halflight/io/scene_limits.h"

namespace halflight {
namespace {

// Pictures decoded before their sizes are added up: bounds the memory a hostile scene can take.
constexpr std::size_t kBatch = 8;

std::vector<std::array<std::uint8_t, 4>> as_opacity(const Image8& image) {
  const bool has_alpha = std::any_of(image.texels.begin(), image.texels.end(),
                                     [](const auto& texel) { return texel[3] != 255; });
  auto texels = image.texels;
  if (has_alpha) return texels;
  for (auto& texel : texels) texel[3] = texel[0];
  return texels;
}

void show(const Picture& picture, Image8& image, Scene& scene) {
  for (const Picture::Shown& shown : picture.shown) {
    Texture& texture = scene.textures[shown.texture];
    texture.width = image.width;
    texture.height = image.height;
    if (shown.use == Picture::Use::opacity) {
      texture.texels = as_opacity(image);
      continue;
    }
    texture.mime_type = mime_type(image_format(picture.bytes));
    if (!texture.mime_type.empty())
      texture.encoded.assign(picture.bytes.begin(), picture.bytes.end());
    const bool last = &shown == &picture.shown.back();
    texture.texels = last ? std::move(image.texels) : image.texels;
  }
}

}  // namespace

void decode_pictures(std::span<Picture> pictures, Scene& scene, ReadWarnings& warnings) {
  ReadBudget texels("texels", kMaxSceneTexels);
  for (std::size_t first = 0; first < pictures.size(); first += kBatch) {
    const auto batch = pictures.subspan(first, std::min(kBatch, pictures.size() - first));
    std::vector<Result<Image8>> images(batch.size());
    parallel_for(batch.size(), 1, [&](std::size_t i) {
      if (batch[i].missing.empty()) images[i] = decode_image(batch[i].bytes, batch[i].where);
    });
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const bool missing = !batch[i].missing.empty();
      if (missing || !images[i]) {
        warnings.add((missing ? batch[i].missing : images[i].error().line()) +
                     "; materials with this texture use their plain colour");
        continue;
      }
      texels.take(images[i]->texels.size() * batch[i].shown.size(), batch[i].where);
      show(batch[i], *images[i], scene);
    }
  }
}

}  // namespace halflight
