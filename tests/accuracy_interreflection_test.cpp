// All reflections: enclosures and pairs of plates whose light is known in closed form. CIE
// 171:2006, 5.8, and the classical enclosures of radiative exchange beside it.
#include "accuracy_case.h"

namespace halflight {
namespace {

using namespace testing;

class AccuracyInterreflection : public AccuracyCase {};

Light isotropic(double flux) {
  Light lamp;
  lamp.intensity = Rgb(static_cast<float>(flux / (4.0 * kPiExact)));
  return lamp;
}

// 10,000 lm in the middle of a cube of 4 m. All that is reflected is phi rho / (A (1 - rho)) on the
// mean, and by symmetry that is the mean of each wall.
TEST_F(AccuracyInterreflection, InternallyReflectedComponentOfACube) {
  const GaussRule<10> rule;
  std::vector<KnownLight> points;
  for (const double u : rule.at)
    for (const double v : rule.at) points.push_back({{4.0 * u, 0, 4.0 * v}, {0, 1, 0}, 0.0});
  for (const double reflectance : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    QuadScene scene;
    scene.box({0, 0, 0}, {4, 4, 4}, scene.material(static_cast<float>(reflectance)), true);
    scene.light_shining_down(isotropic(10000.0), {2, 2, 2});
    const std::vector<double> irradiance = solved(scene, points);
    ASSERT_EQ(irradiance.size(), points.size());
    double mean = 0.0;
    for (std::size_t i = 0; i < 100; ++i) {
      const Point to = Point(2, 2, 2) - points[i].position;
      const double d2 = glm::dot(to, to);
      const double direct = 10000.0 / (4.0 * kPiExact) * to.y / (d2 * std::sqrt(d2));
      mean += rule.weight[i / 10] * rule.weight[i % 10] * (irradiance[i] - direct);
    }
    expect_value(fmt::format("5.8 reflected component, reflectance {}", reflectance),
                 "mean over a wall", mean, 10000.0 / 96.0 * reflectance / (1.0 - reflectance),
                 0.01);
  }
}

// In a sphere every point sees every other alike: E = phi / (A (1 - rho)), wherever the lamp.
// The ball has 24 x 48 cells; points lie in the middle of cells.
Point on_ball(double radius, int ring, int turn) {
  const double polar = kPiExact * (ring + 0.5) / 24.0,
               around = 2.0 * kPiExact * (turn + 0.5) / 48.0;
  return radius * Point(std::sin(polar) * std::sin(around), std::cos(polar),
                        std::sin(polar) * std::cos(around));
}

TEST_F(AccuracyInterreflection, LampInTheMiddleOfASphere) {
  for (const double reflectance : {0.5, 0.9}) {
    QuadScene scene;
    scene.ball(Vec3(0.f), 2.f, scene.material(static_cast<float>(reflectance)), true);
    scene.light_shining_down(isotropic(10000.0), Vec3(0.f));
    std::vector<KnownLight> points;
    for (int ring = 2; ring < 24; ring += 3) {
      const Point x = on_ball(2.0, ring, 5 * ring);
      points.push_back({0.995 * x, -x / 2.0, 10000.0 / (16.0 * kPiExact) / (1.0 - reflectance)});
    }
    expect_at_points(fmt::format("lamp in a sphere, reflectance {}", reflectance), scene, points,
                     0.01);
  }
}

// The inner one emits M. B1 = M + rho1 B2; B2 = rho2 E2, E2 = f B1 + (1 - f) B2 with f = A1 / A2.
TEST_F(AccuracyInterreflection, ConcentricSpheres) {
  const double inner = 0.5, outer = 1.0, share = 0.25;
  struct Reflectances {
    double inner, outer;
  };
  for (const auto& [rho1, rho2] : {Reflectances{0.0, 0.8}, Reflectances{0.7, 0.5}}) {
    QuadScene scene;
    scene.ball(Vec3(0.f), static_cast<float>(inner), scene.material(static_cast<float>(rho1), 10.f),
               false);
    scene.ball(Vec3(0.f), static_cast<float>(outer), scene.material(static_cast<float>(rho2)),
               true);
    const double m = 10.0 * kPiExact;
    const double e2 = share * m / (1.0 - rho2 * (1.0 - share) - rho2 * rho1 * share);
    const double e1 = rho2 * e2;
    std::vector<KnownLight> points;
    for (int ring = 2; ring < 24; ring += 3) {
      const Point x = on_ball(1.0, ring, 5 * ring);
      points.push_back({0.995 * outer * x, -x, e2});
      points.push_back({inner * x, x, e1});
    }
    expect_at_points(fmt::format("concentric spheres, reflectances {} and {}", rho1, rho2), scene,
                     points, 0.01);
  }
}

// Concentric cubes of 1 and 2 m, black, the outer one glows: the inner one sees nothing else, and
// of what the outer one sends a share 1 - A1 / A2 falls back on it.
TEST_F(AccuracyInterreflection, ConcentricBoxes) {
  QuadScene scene;
  scene.box(Vec3(-1.f), Vec3(1.f), scene.material(0.f, 1.f), true);
  scene.box(Vec3(-0.5f), Vec3(0.5f), scene.material(0.f), false);
  std::vector<KnownLight> points;
  for (const double u : {-0.45, -0.2, 0.0, 0.3}) {
    points.push_back({{u, 0.5, 0.4 - u}, {0, 1, 0}, kPiExact});
    points.push_back({{0.5, u, 0.1}, {1, 0, 0}, kPiExact});
  }
  expect_at_points("concentric boxes, inner one", scene, points, 0.01);

  const GaussRule<10> rule;
  std::vector<KnownLight> wall;
  for (const double u : rule.at)
    for (const double v : rule.at) wall.push_back({{2.0 * u - 1, -1, 2.0 * v - 1}, {0, 1, 0}, 0.0});
  const std::vector<double> irradiance = solved(scene, wall);
  ASSERT_EQ(irradiance.size(), wall.size());
  double mean = 0.0;
  for (std::size_t i = 0; i < 100; ++i)
    mean += rule.weight[i / 10] * rule.weight[i % 10] * irradiance[i];
  expect_value("concentric boxes, outer one", "mean over a wall", mean, kPiExact * 0.75, 0.02);
}

// A spherical cavity of emissivity 1 - rho with an opening that takes the share f of its sphere:
// B = M / (1 - rho (1 - f)) everywhere inside (Gouffe), and a point of the opening that looks in
// receives B. f = (1 - cos 60 degrees) / 2.
TEST_F(AccuracyInterreflection, SphericalCavity) {
  const double f = 0.25, rho = 0.8, m = 2.0 * kPiExact;
  QuadScene scene;
  scene.ball(Vec3(0.f), 1.f, scene.material(static_cast<float>(rho), 2.f), true, 24, 0.5f);
  const double b = m / (1.0 - rho * (1.0 - f));
  std::vector<KnownLight> walls, opening;
  for (int ring = 9; ring < 24; ring += 2) {
    const Point x = on_ball(1.0, ring, 5 * ring);
    walls.push_back({0.995 * x, -x, (1.0 - f) * b});
  }
  for (const double x : {-0.6, 0.0, 0.4}) opening.push_back({{x, 0.499, 0.1}, {0, -1, 0}, b});
  expect_at_points("spherical cavity, walls", scene, walls, 0.02);
  expect_at_points("spherical cavity, opening", scene, opening, 0.02);
}

// Endless plates at 1 m: B1 = M + rho1 B2, B2 = rho2 B1. In the middle of 200 x 200 m the edges are
// missed by 1e-4.
TEST_F(AccuracyInterreflection, WideParallelPlates) {
  const double rho1 = 0.5, rho2 = 0.8, m = 3.0 * kPiExact;
  QuadScene scene;
  scene.quad({-100, 1, -100}, {200, 0, 0}, {0, 0, 200},
             scene.material(static_cast<float>(rho1), 3.f));
  scene.quad({-100, 0, -100}, {0, 0, 200}, {200, 0, 0}, scene.material(static_cast<float>(rho2)));
  const double b1 = m / (1.0 - rho1 * rho2);
  std::vector<KnownLight> points;
  for (const double x : {-5.0, 0.0, 3.0}) {
    points.push_back({{x, 0, 2}, {0, 1, 0}, b1});
    points.push_back({{x, 1, -1}, {0, -1, 0}, rho2 * b1});
  }
  expect_at_points("wide parallel plates", scene, points, 0.005);
}

// Unit squares at distance 1, both grey: the integral equation of their radiosity, by Gauss's rule
// of 16 x 16 points on each and its series of reflections.
TEST_F(AccuracyInterreflection, GreyParallelSquares) {
  constexpr std::size_t kSide = 16, kCount = kSide * kSide;
  const GaussRule<kSide> rule;
  const double rho1 = 0.6, rho2 = 0.8, m = 4.0 * kPiExact;
  const auto node = [&](std::size_t i) { return Point(rule.at[i / kSide], 0, rule.at[i % kSide]); };
  const auto gather = [&](const Point& x, const std::vector<double>& b) {
    double e = 0.0;
    for (std::size_t k = 0; k < kCount; ++k) {
      const Point d = node(k) - x;
      const double d2 = 1.0 + glm::dot(d, d);
      e += rule.weight[k / kSide] * rule.weight[k % kSide] * b[k] / (kPiExact * d2 * d2);
    }
    return e;
  };
  std::vector<double> b1(kCount, m), b2(kCount, 0.0);
  for (int bounce = 0; bounce < 40; ++bounce) {
    std::vector<double> next1(kCount), next2(kCount);
    for (std::size_t i = 0; i < kCount; ++i) {
      next1[i] = m + rho1 * gather(node(i), b2);
      next2[i] = rho2 * gather(node(i), b1);
    }
    b1 = next1;
    b2 = next2;
  }
  QuadScene scene;
  scene.quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1}, scene.material(static_cast<float>(rho1), 4.f));
  scene.quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}, scene.material(static_cast<float>(rho2)));
  std::vector<KnownLight> lower, upper;
  for (const double u : {0.1, 0.35, 0.5, 0.8, 0.95}) {
    const Point x(u, 0, 0.9 - 0.8 * u);
    lower.push_back({x, {0, 1, 0}, gather(x, b1)});
    upper.push_back({x + Point(0, 1, 0), {0, -1, 0}, gather(x, b2)});
  }
  expect_at_points("grey parallel squares, receiver", scene, lower, 0.01);
  expect_at_points("grey parallel squares, source", scene, upper, 0.01);
}

// Mean irradiance of one rectangle by another, black: the form factor.
TEST_F(AccuracyInterreflection, FormFactorsOfRectangles) {
  const GaussRule<12> rule;
  std::vector<KnownLight> points;
  for (const double u : rule.at)
    for (const double v : rule.at) points.push_back({{2.0 * u, 0, v}, {0, 1, 0}, 0.0});
  struct Pair {
    const char* name;
    Vec3 corner, u, v;
    double factor;
  };
  for (const Pair& p : {Pair{"parallel rectangles 2 x 1 m at 0.7 m",
                             {0, 0.7f, 0},
                             {2, 0, 0},
                             {0, 0, 1},
                             factor_of_parallel_rectangles(2.0, 1.0, 0.7)},
                        Pair{"perpendicular rectangles, 2 x 1 and 0.6 x 1 m",
                             {0, 0, 0},
                             {0, 0.6f, 0},
                             {0, 0, 1},
                             factor_of_perpendicular_rectangles(2.0, 0.6, 1.0)}}) {
    QuadScene scene;
    scene.quad({0, 0, 0}, {0, 0, 1}, {2, 0, 0}, scene.material(0.f));
    scene.quad(p.corner, p.u, p.v, scene.material(0.f, 1.f));
    const std::vector<double> irradiance = solved(scene, points);
    ASSERT_EQ(irradiance.size(), points.size());
    double mean = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i)
      mean += rule.weight[i / 12] * rule.weight[i % 12] * irradiance[i];
    expect_value(p.name, "form factor", mean / kPiExact, p.factor, 0.005);
  }
}

}  // namespace
}  // namespace halflight
