// One comparison of a picture with its reference: every number that the metrics of this room give.
#pragma once

#include <vector>

#include "halflight/base/image.h"
#include "halflight/features/error_metric.h"
#include "halflight/features/morphology.h"
#include "halflight/features/regions.h"

namespace halflight {

struct Rectangle {
  int left = 0, top = 0, width = 0, height = 0;  // pixels
};

struct CompareOptions {
  std::vector<double> feature_sizes;                // s, pixels; several give a curve
  double p = 2;                                     // exponent of the norm, at least 1
  Connectivity connectivity = Connectivity::eight;  // of erosion and expansion
  std::vector<Rectangle> parts;   // of the picture, for values of their own; within the picture
  std::size_t worst_regions = 0;  // how many features to list, those with the largest error first
  bool keep_maps = false;         // keep mask and local error of every feature size
};

// One connected region of the feature mask, and the L^p norm over it.
struct RegionError {
  Region region;
  double value = 0;
};

struct ErrorAtSize {
  double feature_size = 0;
  FeatureError shadows;              // the paper's metric: features are shadows
  FeatureError symmetric;            // lit regions wider than s are features as well
  std::vector<double> parts;         // the paper's metric over each part
  std::vector<RegionError> regions;  // those with the largest share of the error
  BinaryImage mask;                  // of the paper's metric; with keep_maps
  std::vector<float> local;          // its error at every pixel; with keep_maps
};

struct PartError {
  double l1 = 0, l2 = 0;
};

struct Comparison {
  double l1 = 0, l2 = 0;
  double lp = 0;  // the plain norm with the exponent of the options
  std::vector<PartError> parts;
  std::vector<ErrorAtSize> at_sizes;
};

// `shadow` is where the reference does not see all of the light; all three have the same size.
// Masks and averages of parts and regions are those of the whole picture.
Comparison compare(const Image& reference, const Image& test, const BinaryImage& shadow,
                   const CompareOptions& options);

}  // namespace halflight
