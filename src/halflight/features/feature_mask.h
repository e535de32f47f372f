// Feature masks F^s(f, x) (paper section 2.4): where a picture has illumination features larger
// than s.
#pragma once

#include <span>

#include "halflight/features/binary_image.h"
#include "halflight/features/morphology.h"

namespace halflight {

// The receiver's points with a partial or blocked view of a light: visibility is the seen share of
// the light, 1 = all of it, row by row. Recorded while the reference is traced, never thresholded
// from its brightness. Values within kFullView of 1 are rounding and count as a full view.
inline constexpr float kFullView = 1e-5f;
BinaryImage shadow_of(std::span<const float> visibility, int width, int height);

// p/2 erosions remove features smaller than p pixels; odd and fractional p are rounded.
int erosions_for(double feature_size);  // pixels

// Shadow features: regions of umbra and penumbra wider than s. Pixels beyond the picture neither
// erode nor expand, so a feature that the border cuts counts as continuing.
BinaryImage feature_mask(const BinaryImage& shadow, double feature_size,
                         Connectivity connectivity = Connectivity::eight);

// Section 3.2 counts lit regions inside shadow as features too: shadow or light wider than s.
BinaryImage symmetric_feature_mask(const BinaryImage& shadow, double feature_size,
                                   Connectivity connectivity = Connectivity::eight);

}  // namespace halflight
