// Distances between a picture and its reference: plain L^p norms and the feature-based error metric
// (FBEM, paper section 2.2), both per area, so that pictures of different size compare.
#pragma once

#include <vector>

#include "halflight/base/image.h"
#include "halflight/features/binary_image.h"

namespace halflight {

// test - reference, pixel by pixel. Both have the same size.
Image difference(const Image& reference, const Image& test);

// One error per pixel, in the unit of the picture: ( mean over the channels of |d|^p )^(1/p).
std::vector<float> local_error(const Image& difference, double p);

// ( mean over the pixels of e^p )^(1/p): the L^p norm per area. p >= 1.
double norm(const std::vector<float>& local, double p);

// Errors of the averages over a square of side s: box filters are linear, so the difference is
// filtered, once.
std::vector<float> averaged_error(const Image& difference, double feature_size, double p);

// The error that the FBEM asks for at each pixel: the exact one inside the mask, that of the
// averages outside. Its norm is the FBEM, over the picture or any part of it.
std::vector<float> select_error(const std::vector<float>& exact, const std::vector<float>& averaged,
                                const BinaryImage& mask);

//   ( 1/A Int |test - ref|^p F dx + 1/A Int |box_s test - box_s ref|^p (1 - F) dx )^(1/p)
// with F the feature mask of the reference at feature size s; s -> 0 gives the plain norm.
struct FeatureError {
  double value = 0;       // FBEM
  double features = 0;    // its part inside the mask; value^p = features^p + averages^p
  double averages = 0;    // its part outside
  double mask_share = 0;  // of the area
};
FeatureError feature_error(const std::vector<float>& exact, const std::vector<float>& averaged,
                           const BinaryImage& mask, double p);

}  // namespace halflight
