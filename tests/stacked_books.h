// Books as plain boxes that hide each other, and lines through them: answers for the item buffer
// that no picture was drawn for.
#pragma once

#include <algorithm>
#include <vector>

#include "halflight/rays/sampling.h"
#include "quad_scene.h"

namespace halflight::testing {

// A row of standing books, a pile before it, and a small book (the last) that stands behind them.
inline std::vector<Bounds3f> stacked_books() {
  std::vector<Bounds3f> books;
  float x = 0.f;
  for (const float thickness : {0.03f, 0.05f, 0.02f, 0.04f, 0.035f, 0.045f}) {
    const float height = 0.2f + 1.5f * thickness;
    books.push_back({{x, 0.f, 0.f}, {x + thickness, height, 0.17f}});
    x += thickness + 0.004f;
  }
  float y = 0.f;
  for (const float thickness : {0.04f, 0.03f, 0.02f}) {
    books.push_back({{0.02f + y, y, 0.2f}, {0.17f + y, y + thickness, 0.4f}});
    y += thickness + 0.004f;
  }
  books.push_back({{0.115f, 0.001f, -0.05f}, {0.145f, 0.09f, -0.01f}});
  return books;
}

inline Scene scene_of_books(float radiance = 0.f) {
  QuadScene scene;
  const MaterialId cloth = scene.material(0.5f, radiance);
  for (const Bounds3f& book : stacked_books()) scene.box(book.lower, book.upper, cloth, false);
  scene.scene.sky = Rgb(1.f);  // so that no side is without light
  return scene.scene;
}

struct BookLines {
  float silhouette = 0.f;     // m2
  float facing_layers = 0.f;  // books on a line, on the mean over the silhouette
};
// 1024 x 1024 parallel lines along d.
inline BookLines count_lines(const Vec3& d) {
  constexpr int kLines = 1024;
  const std::vector<Bounds3f> books = stacked_books();
  Bounds3f box;
  for (const Bounds3f& book : books) box.extend(book);
  const Frame frame = Frame::from_normal(d);
  const float side = box.diagonal(), pixel = side / kLines;
  double met = 0, layers = 0;
  for (int y = 0; y < kLines; ++y)
    for (int x = 0; x < kLines; ++x) {
      const Vec2 at = pixel * (Vec2(x, y) + 0.5f) - 0.5f * side;
      const Vec3 p = box.center() + frame.to_world(Vec3(at, 0.f));
      int count = 0;
      for (const Bounds3f& book : books) {
        const Vec3 a = (book.lower - p) / d, b = (book.upper - p) / d;
        if (max_component(glm::min(a, b)) < min_component(glm::max(a, b))) ++count;
      }
      met += count > 0 ? 1 : 0;
      layers += count;
    }
  return {static_cast<float>(met) * pixel * pixel, static_cast<float>(layers / met)};
}

}  // namespace halflight::testing
