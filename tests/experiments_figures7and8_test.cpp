// Figure 8: what is left of the shadows under the desks when clusters are media.
#include <gtest/gtest.h>

#include "experiments/desk_office.h"
#include "experiments/figures7and8.h"
#include "halflight/hierarchy/surfaces.h"

namespace halflight::experiments {
namespace {

class Figure8 : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    offices_ = new std::vector<AverageOffice>(light_office_by_extinction(0, 0));
  }
  static void TearDownTestSuite() { delete offices_; }
  static const AverageOffice& office(const std::string& hierarchy) {
    for (const AverageOffice& o : *offices_)
      if (o.hierarchy == hierarchy) return o;
    ADD_FAILURE() << hierarchy;
    return offices_->front();
  }
  // 1: the shadow is exact or darker, 0: there is none.
  static double kept(double under_desks) {
    const double none = office("no shadows").under_desks;
    return (none - under_desks) / (none - 1.0);
  }

  static std::vector<AverageOffice>* offices_;
};
std::vector<AverageOffice>* Figure8::offices_ = nullptr;

TEST_F(Figure8, OfficeHasAboutAsManyPolygonsAsThePapers) {
  const Geometry geometry = flatten(desk_office().scene);
  EXPECT_NEAR(static_cast<double>(build_surfaces(geometry).surfaces.size()), 5380.0, 300.0);
}

TEST_F(Figure8, ShadowsUnderDesksStayWithFittedExtinction) {
  EXPECT_GT(office("no shadows").under_desks, 4.0);
  EXPECT_NEAR(office("size-grid").under_desks, 1.0, 0.25);
  EXPECT_NEAR(office("goldsmith-salmon").under_desks, 1.0, 0.25);
  EXPECT_NEAR(office("agglomerative").under_desks, 1.0, 0.25);
  // Too dark, not lost: its clusters of straddling surfaces are wide.
  EXPECT_LT(office("kd-tree").under_desks, 0.75);
}

// As published every hierarchy loses much of the shadow: a slab as a medium of extinction A / 4V
// lets exp(-1/2) of the light through. Whole cells of a k-d tree lose more than half.
TEST_F(Figure8, PublishedExtinctionLosesMostShadowInCellsOfTheKdTree) {
  const double cells = kept(office("kd-tree, whole cells").under_desks_published);
  EXPECT_LT(cells, 0.5);
  for (const char* name : {"size-grid", "kd-tree", "goldsmith-salmon", "agglomerative"}) {
    EXPECT_GT(kept(office(name).under_desks_published), cells) << name;
    EXPECT_GT(kept(office(name).under_desks_published), 0.5) << name;
  }
}

TEST_F(Figure8, AgglomerativeClustersNeedTheFewestNodes) {
  for (const char* name : {"size-grid", "kd-tree", "goldsmith-salmon"}) {
    EXPECT_LT(office("agglomerative").exact_nodes, office(name).exact_nodes) << name;
    EXPECT_LT(office("agglomerative").average_nodes, office(name).average_nodes) << name;
  }
}

}  // namespace
}  // namespace halflight::experiments
