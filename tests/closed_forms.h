// Closed forms of diffuse light, in double precision and apart from the library's own.
#pragma once

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "halflight/base/vec.h"

namespace halflight::testing {

inline constexpr double kPiExact = std::numbers::pi;

using Point = glm::dvec3;

// E / (pi L) at x, on a plane with unit normal n, under a polygon of radiance L that lies above the
// plane: Lambert's sum over its edges, angle times the cosine of the normal of the edge's plane.
inline double configuration_factor(const Point& x, const Point& n,
                                   const std::vector<Point>& polygon) {
  double sum = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Point a = glm::normalize(polygon[i] - x);
    const Point b = glm::normalize(polygon[(i + 1) % polygon.size()] - x);
    const Point normal = glm::cross(a, b);
    const double sine = glm::length(normal);
    if (sine > 1e-14) sum += std::atan2(sine, glm::dot(a, b)) * glm::dot(normal, n) / sine;
  }
  return std::abs(sum) / (2.0 * kPiExact);
}

inline std::vector<Point> rectangle(const Point& corner, const Point& u, const Point& v) {
  return {corner, corner + u, corner + u + v, corner + v};
}

// From a point to a rectangle a x b parallel to its plane at distance c, above one corner (Howell
// B-4), and to one perpendicular to it, of height a and width b, at distance c, corner at its foot
// (B-5).
inline double factor_to_parallel_corner(double a, double b, double c) {
  const double x = a / c, y = b / c;
  const double rx = std::sqrt(1.0 + x * x), ry = std::sqrt(1.0 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2.0 * kPiExact);
}
inline double factor_to_upright_corner(double a, double b, double c) {
  const double x = a / b, y = c / b, r = std::sqrt(x * x + y * y);
  return (std::atan(1.0 / y) - y / r * std::atan(1.0 / r)) / (2.0 * kPiExact);
}

// Between rectangles a x b that face each other at distance c (C-11).
inline double factor_of_parallel_rectangles(double a, double b, double c) {
  const double x = a / c, y = b / c, x2 = 1.0 + x * x, y2 = 1.0 + y * y;
  return 2.0 / (kPiExact * x * y) *
         (0.5 * std::log(x2 * y2 / (x2 + y * y)) +
          x * std::sqrt(y2) * std::atan(x / std::sqrt(y2)) +
          y * std::sqrt(x2) * std::atan(y / std::sqrt(x2)) - x * std::atan(x) - y * std::atan(y));
}

// From a rectangle of width w to one of height h at right angles that shares the edge of length l
// (C-14).
inline double factor_of_perpendicular_rectangles(double w, double h, double l) {
  const double a = w / l, b = h / l, a2 = a * a, b2 = b * b, r = std::sqrt(a2 + b2);
  const double logs = std::log((1 + a2) * (1 + b2) / (1 + a2 + b2)) +
                      a2 * std::log(a2 * (1 + a2 + b2) / ((1 + a2) * (a2 + b2))) +
                      b2 * std::log(b2 * (1 + a2 + b2) / ((1 + b2) * (a2 + b2)));
  return (a * std::atan(1 / a) + b * std::atan(1 / b) - r * std::atan(1 / r) + 0.25 * logs) /
         (kPiExact * a);
}

// Nodes and weights of Gauss and Legendre on [0, 1], by Newton's method.
template <int N>
struct GaussRule {
  std::array<double, N> at{}, weight{};
  GaussRule() {
    for (int i = 0; i < N; ++i) {
      double x = std::cos(kPiExact * (i + 0.75) / (N + 0.5)), slope = 1.0;
      for (int step = 0; step < 50; ++step) {
        double p = x, before = 1.0;
        for (int k = 2; k <= N; ++k) {
          const double next = ((2 * k - 1) * x * p - (k - 1) * before) / k;
          before = p;
          p = next;
        }
        slope = N * (x * p - before) / (x * x - 1.0);
        x -= p / slope;
      }
      at[static_cast<std::size_t>(i)] = 0.5 * (1.0 + x);
      weight[static_cast<std::size_t>(i)] = 1.0 / ((1.0 - x * x) * slope * slope);
    }
  }
};

}  // namespace halflight::testing
