#include "halflight/io/gltf_fixtures.h"

#include "halflight/scene/radiance.h"

namespace halflight {
namespace {

float positive(const JsonCursor& number) {
  const float value = number.finite_float();
  if (!(value > 0.f)) number.fail("this should be more than 0");
  return value;
}

Camera read_camera(const JsonCursor& json) {
  Camera camera;
  camera.name = json.name();
  const std::string type = json.at("type").string();
  camera.perspective = type == "perspective";
  if (camera.perspective) {
    const JsonCursor perspective = json.at("perspective");
    camera.vertical_fov = positive(perspective.at("yfov"));
    if (camera.vertical_fov >= kPi) perspective.at("yfov").fail("this should be less than pi");
    if (const auto aspect = perspective.find("aspectRatio")) camera.aspect = positive(*aspect);
  } else if (type == "orthographic") {
    const JsonCursor orthographic = json.at("orthographic");
    camera.half_height = positive(orthographic.at("ymag"));
    camera.aspect = positive(orthographic.at("xmag")) / camera.half_height;
  } else {
    json.at("type").fail("'" + type + "' is not a kind of camera");
  }
  return camera;
}

void read_cone(const JsonCursor& json, Light& light) {
  const auto spot = json.find("spot");
  if (!spot) return;
  light.inner_cone_angle = spot->float_or("innerConeAngle", 0.f);
  light.outer_cone_angle = spot->float_or("outerConeAngle", kPi / 4);
  // Half a right angle may be written a little above pi/2 in decimal.
  const bool ordered = light.inner_cone_angle >= 0.f &&
                       light.inner_cone_angle <= light.outer_cone_angle &&
                       light.outer_cone_angle <= kPi / 2 + 1e-4f;
  if (!ordered) spot->fail("the cone angles should be 0 <= inner <= outer <= pi/2");
}

Light read_light(const JsonCursor& json) {
  Light light;
  light.name = json.name();
  const std::string type = json.at("type").string();
  if (type == "point")
    light.kind = Light::Kind::point;
  else if (type == "spot")
    light.kind = Light::Kind::spot;
  else if (type == "directional")
    light.kind = Light::Kind::directional;
  else
    json.at("type").fail("'" + type + "' is not a kind of light");
  light.intensity = Rgb(1.f);
  json.read_numbers("color", 3, light.intensity);
  light.intensity *= json.float_or("intensity", 1.f);
  if (!is_radiance(light.intensity))
    json.fail("the intensity is negative or too large", "give it in candela or lux");
  if (const auto range = json.find("range")) light.range = positive(*range);
  if (light.kind == Light::Kind::spot) read_cone(json, light);
  return light;
}

}  // namespace

CameraId GltfFixtures::camera(const JsonCursor& index) {
  const JsonCursor json = document_.element("cameras", index);
  const auto [known, added] = camera_of_index_.try_emplace(index.count());
  if (added) known->second = scene_.cameras.push_back(read_camera(json));
  return known->second;
}

LightId GltfFixtures::light(const JsonCursor& index) {
  const auto extension = document_.root().extension("KHR_lights_punctual");
  if (!extension) index.fail("the scene has no lights");
  const JsonCursor lights = extension->at("lights");
  const std::size_t i = index.index_below(lights.size(), "light");
  const auto [known, added] = light_of_index_.try_emplace(i);
  if (added) known->second = scene_.lights.push_back(read_light(lights[i]));
  return known->second;
}

}  // namespace halflight
