// Figure 10: a shelf of books as one cluster, with and without visibility inside it.
#pragma once

#include <vector>

#include "halflight/base/image.h"
#include "halflight/scene/scene.h"

namespace halflight::experiments {

// One link from the light to all books: an unoccluded, parallel light of their size.
struct LinkToBooks {
  std::size_t items = 0;     // cells of the books
  double silhouette = 0;     // m2, counted exactly along the link
  double given_with = 0;     // light handed out to the items, over irradiance: m2
  double given_without = 0;  // to all that face the light
  double hidden_with = 0;    // of it on items of which nothing is seen, by exact rays
  double hidden_without = 0;
  Image with, without;  // 1 is white; the link in purple
};
LinkToBooks link_light_to_books(int seed, int width, int height);

// A whole scene solved with clusters up to the feature size receiving as one.
struct SolvedClusters {
  bool refined_links = false;
  bool intra_cluster = false;
  std::size_t items = 0;  // sides inside such clusters that are looked at
  // Of their irradiance against path tracing, as shares of its mean over their area.
  double error = 0;  // RMS
  double bias = 0;
  double absorbed = 0;  // share of the emitted power
  double seconds = 0;
};
// Both kinds of links, each without and with intra-cluster visibility.
std::vector<SolvedClusters> solve_with_and_without(Scene scene, float feature_size);

}  // namespace halflight::experiments
