#include "halflight/rays/camera_rays.h"

namespace halflight {
namespace {

// A unit vector square to `forward`, in the plane of forward and up where these are apart.
Vec3 square_up(const Vec3& forward, const Vec3& up) {
  const Vec3 across = glm::cross(forward, up);
  const float length = glm::length(across);
  if (!(length > 1e-6f)) return Frame::from_normal(forward).tangent;
  return glm::cross(across / length, forward);
}

}  // namespace

CameraRays::CameraRays(const PlacedCamera& camera, int width, int height)
    : camera_(camera), size_(width, height) {
  camera_.forward = glm::normalize(camera.forward);
  const float half_height =
      camera.perspective ? std::tan(0.5f * camera.vertical_fov) : camera.half_height;
  const Vec3 up = square_up(camera_.forward, camera.up);
  up_ = up * half_height;
  right_ = glm::cross(camera_.forward, up) * (half_height * size_.x / size_.y);
}

CameraRay CameraRays::through(Vec2 pixel) const {
  const Vec2 at = 2.f * pixel / size_ - 1.f;
  const Vec3 offset = at.x * right_ - at.y * up_;
  if (!camera_.perspective) return {camera_.position + offset, camera_.forward};
  return {camera_.position, glm::normalize(camera_.forward + offset)};
}

}  // namespace halflight
