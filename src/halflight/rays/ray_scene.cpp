#include "halflight/rays/ray_scene.h"

#include <algorithm>
#include <array>
#include <new>
#include <stdexcept>
#include <string>

#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include "halflight/base/counter.h"
#include "halflight/base/morton_order.h"
#include "halflight/rays/sampling.h"

namespace halflight {
namespace {

// Answers differ in the last bit between instruction sets with and without fused multiply-add
// (RenderKit/embree#51); AVX2 is on every processor since 2013 that this is meant for.
constexpr const char* kInstructionSet = "avx2";

// What the filters need beyond Embree's own context.
struct Context : RTCIntersectContext {
  const Scene* scene;
  const Geometry* geometry;
  const TriangleId* triangles;  // of the transparent mesh, by primitive id
  float transmittance = 1.f;
  std::optional<std::uint64_t> seed;  // none: nothing passes
};

// Shadow rays: weaken and pass on until the ray is as good as blocked.
void attenuate(const RTCFilterFunctionNArguments* args) {
  auto* context = static_cast<Context*>(args->context);
  if (args->valid[0] != -1) return;
  const TriangleId t = context->triangles[RTCHitN_primID(args->hit, 1, 0)];
  const Vec2 barycentric(RTCHitN_u(args->hit, 1, 0), RTCHitN_v(args->hit, 1, 0));
  context->transmittance *= 1.f - opacity_at(*context->scene, *context->geometry, t, barycentric);
  if (context->transmittance >= kBlockedBelow) args->valid[0] = 0;
}

// Path rays: pass with probability 1 - opacity, without a seed only where the opacity is 0.
void pass_by_chance(const RTCFilterFunctionNArguments* args) {
  auto* context = static_cast<Context*>(args->context);
  if (args->valid[0] != -1) return;
  const TriangleId t = context->triangles[RTCHitN_primID(args->hit, 1, 0)];
  const Vec2 barycentric(RTCHitN_u(args->hit, 1, 0), RTCHitN_v(args->hit, 1, 0));
  const float opacity = opacity_at(*context->scene, *context->geometry, t, barycentric);
  const float chance = context->seed ? to_unit_float(hash(*context->seed, t.value)) : 0.f;
  if (chance >= opacity) args->valid[0] = 0;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  const Scene* source = nullptr;
  const Geometry* geometry = nullptr;
  mutable Counter rays;
  // Embree geometry 0 holds the opaque triangles, 1 those that may let light through.
  std::array<std::vector<TriangleId>, 2> triangles;
  bool all_opaque = false;  // then there are no lists, and triangles have their own numbers

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  // Embree answers with nothing where it lacks memory, and may end the program when it is to take
  // apart what it could not finish: that is left behind.
  void check() {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE && device != nullptr) return;
    scene = nullptr;
    device = nullptr;
    if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
    throw std::runtime_error("Embree fails with its error " + std::to_string(error));
  }

  // Embree reads 16 bytes of each vertex, so there must be memory behind the last one.
  void attach_vertices(RTCGeometry mesh) {
    const std::vector<Vec3>& positions = geometry->positions.raw();
    if (positions.capacity() > positions.size()) {
      rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                 positions.data(), 0, sizeof(Vec3), positions.size());
      return;
    }
    void* copy = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                         sizeof(Vec3), positions.size());
    check();
    std::copy(positions.begin(), positions.end(), static_cast<Vec3*>(copy));
  }

  void attach(unsigned which) {
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    attach_vertices(mesh);
    const auto& ids = triangles[which];
    if (all_opaque) {
      rtcSetSharedGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                 geometry->triangles.raw().data(), 0, sizeof(std::uint32_t[3]),
                                 geometry->triangles.size());
      return finish(mesh, which);
    }
    auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), ids.size()));
    check();
    for (std::size_t i = 0; i < ids.size(); ++i)
      for (int k = 0; k < 3; ++k) indices[3 * i + k] = geometry->triangles[ids[i]][k].value;
    if (which == 1) {
      rtcSetGeometryOccludedFilterFunction(mesh, attenuate);
      rtcSetGeometryIntersectFilterFunction(mesh, pass_by_chance);
    }
    finish(mesh, which);
  }
  void finish(RTCGeometry mesh, unsigned which) {
    check();
    rtcCommitGeometry(mesh);
    rtcAttachGeometryByID(scene, mesh, which);
    rtcReleaseGeometry(mesh);
  }

  TriangleId triangle_of(unsigned mesh, unsigned primitive) const {
    return all_opaque ? TriangleId(primitive) : triangles[mesh][primitive];
  }

  std::optional<RayHit> intersect(const Vec3& origin, const Vec3& direction, float max_distance,
                                  std::optional<std::uint64_t> seed) const;

  Context make_context(std::optional<std::uint64_t> seed) const {
    Context c{};
    rtcInitIntersectContext(&c);
    c.scene = source;
    c.geometry = geometry;
    c.triangles = triangles[1].data();
    c.seed = seed;
    return c;
  }
};

namespace {

RTCRay make_ray(const Vec3& origin, const Vec3& direction, float far) {
  RTCRay ray{};
  ray.org_x = origin.x;
  ray.org_y = origin.y;
  ray.org_z = origin.z;
  ray.dir_x = direction.x;
  ray.dir_y = direction.y;
  ray.dir_z = direction.z;
  ray.tnear = 0.f;
  ray.tfar = far;
  ray.mask = ~0u;
  return ray;
}

}  // namespace

std::optional<RayHit> RayScene::Impl::intersect(const Vec3& origin, const Vec3& direction,
                                                float max_distance,
                                                std::optional<std::uint64_t> seed) const {
  rays.add();
  Context context = make_context(seed);
  RTCRayHit query{};
  query.ray = make_ray(origin, direction, max_distance);
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(scene, &context, &query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  RayHit hit;
  hit.triangle = triangle_of(query.hit.geomID, query.hit.primID);
  hit.barycentric = {query.hit.u, query.hit.v};
  hit.distance = query.ray.tfar;
  const Vec3 normal(query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z);
  hit.front = glm::dot(normal, direction) < 0.f;
  return hit;
}

RayScene::RayScene(const Scene& scene, const Geometry& geometry) : impl_(std::make_shared<Impl>()) {
  _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
  _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
  impl_->source = &scene;
  impl_->geometry = &geometry;
  const auto transparent = [&](MaterialId m) { return may_be_transparent(scene.materials[m]); };
  impl_->all_opaque =
      !geometry.triangles.empty() &&
      std::none_of(geometry.materials.begin(), geometry.materials.end(), transparent);
  if (!impl_->all_opaque)
    for (std::size_t i = 0; i < geometry.triangles.size(); ++i)
      impl_->triangles[transparent(geometry.materials[TriangleId(i)])].push_back(TriangleId(i));
  impl_->device = rtcNewDevice((std::string("isa=") + kInstructionSet).c_str());
  impl_->check();
  impl_->scene = rtcNewScene(impl_->device);
  impl_->check();
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  for (unsigned which = 0; which < 2; ++which)
    if (!impl_->triangles[which].empty() || (which == 0 && impl_->all_opaque)) impl_->attach(which);
  rtcCommitScene(impl_->scene);
  impl_->check();

  lift_distance_ = halflight::lift_distance(geometry.bounds);
}

RayScene::~RayScene() = default;
RayScene::RayScene(const RayScene& other, std::shared_ptr<const void> owner)
    : impl_(other.impl_), owner_(std::move(owner)), lift_distance_(other.lift_distance_) {}
RayScene::RayScene(RayScene&&) noexcept = default;
RayScene& RayScene::operator=(RayScene&&) noexcept = default;

float RayScene::transmittance(const Vec3& from, const Vec3& to) const {
  impl_->rays.add();
  Context context = impl_->make_context(0);
  RTCRay ray = make_ray(from, to - from, 1.f);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0.f ? 0.f : context.transmittance;
}

float RayScene::transmittance_to_sky(const Vec3& from, const Vec3& direction) const {
  impl_->rays.add();
  Context context = impl_->make_context(0);
  RTCRay ray = make_ray(from, direction, kInfinity);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar < 0.f ? 0.f : context.transmittance;
}

std::optional<RayHit> RayScene::closest_hit(const Vec3& origin, const Vec3& direction,
                                            float max_distance, std::uint64_t seed) const {
  return impl_->intersect(origin, direction, max_distance, seed);
}

// Rays that go the same way from places near each other meet the same parts of the scene.
std::vector<std::optional<RayHit>> RayScene::closest_hits(std::span<const RayQuery> queries) const {
  constexpr int kBitsOfAxis = 4;
  std::vector<std::uint64_t> ways(queries.size());
  for (std::size_t i = 0; i < queries.size(); ++i)
    ways[i] = morton_code(queries[i].direction, {Vec3(-1.f), Vec3(1.f)}) >> (63 - 3 * kBitsOfAxis);
  std::vector<std::optional<RayHit>> hits(queries.size());
  for (const std::uint32_t i : order_by_key(ways))
    hits[i] = closest_hit(queries[i].origin, queries[i].direction, kInfinity, queries[i].seed);
  return hits;
}

std::optional<RayHit> RayScene::first_surface(const Vec3& origin, const Vec3& direction,
                                              float max_distance) const {
  return impl_->intersect(origin, direction, max_distance, std::nullopt);
}

std::vector<TriangleId> RayScene::triangles_near(const Vec3& point, float radius) const {
  struct Found {
    const Impl* impl;
    std::vector<TriangleId> triangles;
  } found{impl_.get(), {}};
  RTCPointQuery query{point.x, point.y, point.z, 0.f, radius};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const auto collect = [](RTCPointQueryFunctionArguments* args) {
    auto* to = static_cast<Found*>(args->userPtr);
    to->triangles.push_back(to->impl->triangle_of(args->geomID, args->primID));
    return false;  // the radius stays as it is
  };
  rtcPointQuery(impl_->scene, &query, &context, collect, &found);
  std::sort(found.triangles.begin(), found.triangles.end());
  return std::move(found.triangles);
}

std::uint64_t RayScene::ray_total() const { return impl_->rays.total(); }

const char* RayScene::instruction_set() { return kInstructionSet; }

}  // namespace halflight
