// Finds the view that a user asks for by a few words.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "halflight/base/result.h"
#include "halflight/io/camera_file.h"
#include "halflight/scene/geometry.h"

namespace halflight {

// `wish` is the name of a camera of the scene, its index, a JSON file (io/camera_file.h),
// "px,py,pz,tx,ty,tz[,fov]" (position and target in the coordinates of the scene file, vertical
// field of view in degrees), or "auto": the scene's first camera, else `automatic()`.
Result<View> choose_view(const std::string& wish, const Scene& scene, const Geometry& geometry,
                         const std::function<PlacedCamera()>& automatic);

// Pixels of a picture of the view, width and height: as many as it asks for, else 1280 by 720, or
// by what the camera's aspect ratio makes of it, at most four times 1280.
std::pair<int, int> picture_size(const View& view);

}  // namespace halflight
