#include "halflight/io/pictures.h"

#include <algorithm>

#include "halflight/base/parallel.h"
#include "halflight/io/image_reader.h"
#include "halflight/io/scene_limits.h"

namespace halflight {
namespace {

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

// Images may lie over each other, and a picture of a few bytes may claim any size: what decoding
// all of them takes is known before it begins.
void check_sizes(std::span<const Picture> pictures) {
  ReadBudget bytes("bytes of pictures", kMaxPictureBytes), texels("texels", kMaxSceneTexels);
  for (const Picture& picture : pictures) {
    bytes.take(picture.bytes.size() * picture.shown.size(), picture.where);
    const auto size = image_size(picture.bytes, picture.where);
    if (size) texels.take(size->texels() * picture.shown.size(), picture.where);
  }
}

}  // namespace

void decode_pictures(std::span<Picture> pictures, Scene& scene, ReadWarnings& warnings) {
  check_sizes(pictures);
  std::vector<Result<Image8>> images(pictures.size());
  parallel_for(pictures.size(), 1, [&](std::size_t i) {
    if (pictures[i].missing.empty()) images[i] = decode_image(pictures[i].bytes, pictures[i].where);
  });
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const bool missing = !pictures[i].missing.empty();
    if (!missing && images[i]) {
      show(pictures[i], *images[i], scene);
      continue;
    }
    warnings.add((missing ? pictures[i].missing : images[i].error().line()) +
                 "; materials with this texture use their plain colour");
  }
}

}  // namespace halflight
