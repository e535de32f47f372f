#include "halflight/scene/procedural/small_objects.h"

#include <glm/ext/matrix_transform.hpp>

#include "halflight/scene/procedural/assembly.h"

namespace halflight {
namespace {

struct Dye {
  const char* name;
  Rgb reflectance;
};
constexpr std::array<Dye, 8> kBookCloths{{{"wine cloth", {0.33f, 0.05f, 0.07f}},
                                          {"navy cloth", {0.05f, 0.09f, 0.28f}},
                                          {"moss cloth", {0.14f, 0.24f, 0.08f}},
                                          {"ochre cloth", {0.62f, 0.4f, 0.1f}},
                                          {"sand cloth", {0.6f, 0.5f, 0.36f}},
                                          {"grey cloth", {0.3f, 0.31f, 0.33f}},
                                          {"orange cloth", {0.7f, 0.24f, 0.06f}},
                                          {"sky cloth", {0.25f, 0.46f, 0.6f}}}};
constexpr std::array<Dye, 3> kBinderBoards{{{"black board", Rgb(0.06f)},
                                            {"blue board", {0.07f, 0.16f, 0.42f}},
                                            {"red board", {0.5f, 0.06f, 0.06f}}}};
constexpr std::array<Dye, 4> kInks{{{"blue pen", {0.05f, 0.1f, 0.45f}},
                                    {"red pen", {0.55f, 0.05f, 0.05f}},
                                    {"black pen", Rgb(0.05f)},
                                    {"yellow pencil", {0.75f, 0.55f, 0.06f}}}};
constexpr std::array<Dye, 3> kNotes{{{"yellow note", {0.85f, 0.78f, 0.25f}},
                                     {"pink note", {0.85f, 0.4f, 0.5f}},
                                     {"green note", {0.45f, 0.75f, 0.35f}}}};

// Two boards and a spine around a block of pages, with a title on the spine.
MeshId add_book(Scene& scene, const Dye& cloth, MaterialId pages, MaterialId title) {
  const MaterialId cover = add_material(scene, cloth.name, cloth.reflectance);
  MeshParts parts;
  append_box(parts[cover], {{0.f, 0.f, 0.f}, {0.08f, 1.f, 1.f}});
  append_box(parts[cover], {{0.92f, 0.f, 0.f}, {1.f, 1.f, 1.f}});
  append_box(parts[cover], {{0.08f, 0.f, 0.97f}, {0.92f, 1.f, 1.f}});
  append_box(parts[pages], {{0.08f, 0.015f, 0.03f}, {0.92f, 0.985f, 0.97f}});
  const Bounds3f band{{0.12f, 0.68f, 1.002f}, {0.88f, 0.84f, 1.002f}};
  append_quad(parts[title], side_of(band, Side::z_high));
  return add_mesh(scene, std::string("book in ") + cloth.name, std::move(parts));
}

// A lever-arch file: a case that is open at the top, with a label and a finger hole on its spine.
MeshId add_binder(Scene& scene, const Dye& board, MaterialId pages, MaterialId label) {
  const MaterialId cover = add_material(scene, board.name, board.reflectance);
  MeshParts parts;
  append_box(parts[cover], {{0.f, 0.f, 0.f}, {0.04f, 1.f, 1.f}});
  append_box(parts[cover], {{0.96f, 0.f, 0.f}, {1.f, 1.f, 1.f}});
  append_box(parts[cover], {{0.04f, 0.f, 0.99f}, {0.96f, 1.f, 1.f}});
  append_box(parts[pages], {{0.1f, 0.005f, 0.03f}, {0.8f, 0.94f, 0.9f}});
  const Bounds3f paper{{0.14f, 0.45f, 1.002f}, {0.86f, 0.9f, 1.002f}};
  append_quad(parts[label], side_of(paper, Side::z_high));
  const std::array<Vec2, 2> hole{Vec2(0.f), {0.2f, 0.f}};
  Primitive disc;
  append_revolution(disc, Vec3(0.f), {0.f, 0.f, -1.f}, hole, 12);
  // Round in the end: thickness is about a fifth of the height.
  append_moved(parts[label], disc, placed_at({0.5f, 0.15f, 1.002f}, 0.f, {1.f, 0.22f, 1.f}));
  return add_mesh(scene, std::string("binder of ") + board.name, std::move(parts));
}

MeshId add_pen(Scene& scene, const Dye& ink) {
  const MaterialId barrel = add_material(scene, ink.name, ink.reflectance);
  constexpr std::array<Vec2, 6> kProfile{Vec2(0.f),        {0.001f, 0.f},     {0.004f, 0.014f},
                                         {0.004f, 0.138f}, {0.0025f, 0.141f}, {0.f, 0.141f}};
  MeshParts parts;
  append_revolution(parts[barrel], Vec3(0.f), {0.f, 1.f, 0.f}, kProfile, 8);
  return add_mesh(scene, ink.name, std::move(parts));
}

// A4 in a dozen layers, none quite square on the one below.
MeshId add_paper_stack(Scene& scene, MaterialId paper, std::uint64_t seed) {
  constexpr float kLayer = 0.003f;
  Random random(seed);
  MeshParts parts;
  Primitive layer;
  append_box(layer, {{-0.105f, 0.f, -0.1485f}, {0.105f, kLayer - 0.0001f, 0.1485f}});
  for (int i = 0; i < 12; ++i) {
    const float dx = random.uniform(-0.008f, 0.008f), dz = random.uniform(-0.008f, 0.008f);
    append_moved(parts[paper], layer,
                 placed_at({dx, kLayer * static_cast<float>(i), dz}, random.uniform(-.06f, .06f)));
  }
  return add_mesh(scene, "paper stack", std::move(parts));
}

MeshId add_flat(Scene& scene, const std::string& name, MaterialId paper, float width,
                float length) {
  const Vec3 half(0.5f * width, 0.f, 0.5f * length);
  MeshParts parts;
  append_quad(parts[paper], side_of({-half, half}, Side::y_high));
  return add_mesh(scene, name, std::move(parts));
}

}  // namespace

std::vector<MeshId> add_books(Scene& scene) {
  const MaterialId pages = add_material(scene, "book pages", {0.78f, 0.73f, 0.62f});
  const MaterialId title = add_material(scene, "book title", {0.8f, 0.77f, 0.68f});
  std::vector<MeshId> books;
  for (const Dye& cloth : kBookCloths) books.push_back(add_book(scene, cloth, pages, title));
  return books;
}

SmallObjects add_small_objects(Scene& scene, std::uint64_t seed) {
  const MaterialId paper = add_material(scene, "paper", Rgb(0.8f));
  const MaterialId sheet = add_sheet_material(scene, "sheet of paper", Rgb(0.8f));
  SmallObjects objects;
  objects.books = add_books(scene);
  for (const Dye& board : kBinderBoards)
    objects.binders.push_back(add_binder(scene, board, paper, paper));
  for (const Dye& ink : kInks) objects.pens.push_back(add_pen(scene, ink));
  objects.paper_stack = add_paper_stack(scene, paper, seed);
  objects.sheet = add_flat(scene, "sheet of paper", sheet, 0.21f, 0.297f);
  for (const Dye& note : kNotes) {
    const MaterialId material = add_sheet_material(scene, note.name, note.reflectance);
    objects.notes.push_back(add_flat(scene, note.name, material, 0.076f, 0.076f));
  }
  return objects;
}

Vec3 random_book_size(Random& random) {
  const float thickness = random.uniform(0.015f, 0.05f);
  const float height = random.uniform(0.18f, 0.285f);
  return {thickness, height, height * random.uniform(0.66f, 0.8f)};
}

Mat4 lying_book(const Vec3& position, const Vec3& size, float turn) {
  const Mat4 placed = placed_at(position, turn);
  const Mat4 laid = glm::rotate(placed, 0.5 * static_cast<double>(kPi), glm::dvec3(0.0, 0.0, 1.0));
  // Standing, the book begins at its corner; lying, its height runs along -x and thickness along
  // +y.
  const Mat4 centred = glm::translate(laid, glm::dvec3(0.0, -0.5 * static_cast<double>(size.y),
                                                       -0.5 * static_cast<double>(size.z)));
  return glm::scale(centred, glm::dvec3(size));
}

}  // namespace halflight
