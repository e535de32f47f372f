// What each address of the live view answers, without a server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "halflight/io/image_reader.h"
#include "halflight/view/view_routes.h"
#include "live_view.h"

namespace halflight {
namespace {

using nlohmann::json;
using testing::array_of;
using testing::json_of;
using testing::Live;
using testing::room;

const char* const kDown = R"({"position": [1.4, 2, 1.4], "forward": [0, -1, 0], "up": [0, 0, 1],
                              "fov": 0.5, "width": 16, "height": 12})";

// The room with a picture of texels alone on its walls, and another one of bytes that a browser
// reads.
Scene decorated_room() {
  Scene scene = room();
  Texture photo;
  photo.width = photo.height = 1;
  photo.texels = {{10, 20, 30, 255}};
  photo.wrap_u = Wrap::mirror;
  TextureRef& paper = scene.materials[MaterialId(0)].reflectance_texture;
  paper.texture = scene.textures.push_back(photo);
  paper.uv_transform = {2, 0, 5, 0, 3, 7};
  photo.mime_type = "image/jpeg";
  photo.encoded = {0xff, 0xd8, 0xff};
  scene.textures.push_back(photo);
  return scene;
}

class ViewRoutes : public ::testing::Test {
 protected:
  ViewRoutes()
      : live_(decorated_room()),
        handler_(view_routes(live_.session, {{"", {"text/html", "<html>"}}})) {}

  WebReply get(const std::string& path, std::map<std::string, std::string> query = {}) {
    return handler_({false, path, std::move(query), ""});
  }
  WebReply post(const std::string& path, const std::string& body) {
    return handler_({true, path, {}, body});
  }
  std::string layer(const std::string& kind, const std::string& more = "") {
    const WebReply reply = post("api/layer", R"({"kind": ")" + kind + '"' + more + "}");
    EXPECT_EQ(reply.status, 200) << kind << ": " << *reply.body;
    return *reply.body;
  }

  Live live_;
  LoopbackServer::Handler handler_;
};

TEST_F(ViewRoutes, HaveThePageAndRefuseTheRest) {
  EXPECT_EQ(get("").type, "text/html");
  EXPECT_EQ(*get("").body, "<html>");
  EXPECT_EQ(get("api/nothing").status, 404);
  EXPECT_EQ(get("api/control").status, 404) << "is only posted to";
  EXPECT_EQ(post("api/status", "").status, 404);
}

TEST_F(ViewRoutes, TellHowFarTheLightIs) {
  ASSERT_TRUE(live_.done());
  const json status = json::parse(*get("api/status").body);
  EXPECT_EQ(status["phase"], "done");
  const json history = json::parse(*get("api/history").body);
  EXPECT_FALSE(history.empty());
  const WebReply stream = get("api/events");
  ASSERT_TRUE(stream.events);
  const auto first = stream.events();
  ASSERT_TRUE(first);
  EXPECT_THAT(*first, ::testing::StartsWith("data: {"));
  EXPECT_THAT(*first, ::testing::EndsWith("}\n\n"));
  EXPECT_EQ(*stream.events(), "") << "nothing new within a second";
}

TEST_F(ViewRoutes, GiveTheMeshItsLightAndItsPictures) {
  ASSERT_TRUE(live_.done());
  const WebReply topology = get("api/topology");
  ASSERT_EQ(topology.status, 200);
  const json header = json_of(*topology.body);
  const json& paper = header["materials"][0]["texture"];
  EXPECT_EQ(paper["id"], 0);
  EXPECT_EQ(paper["wrapU"], "mirror");
  EXPECT_EQ(paper["wrapV"], "repeat");
  const auto uvs = array_of<Vec2>(*topology.body, "uvs");
  const auto [u_low, u_high] = std::minmax_element(
      uvs.begin(), uvs.end(), [](const Vec2& a, const Vec2& b) { return a.x < b.x; });
  EXPECT_EQ(u_high->x, 7.f) << "2 x 1 + 5; others have none and stay 0";
  EXPECT_EQ(u_low->x, 0.f);
  const std::string epoch = header["epoch"].dump();
  const std::string light = *get("api/light", {{"epoch", epoch}, {"since", "0"}}).body;
  EXPECT_FALSE(array_of<std::uint32_t>(light, "light").empty());
  const std::string version = json_of(light)["version"].dump();
  const std::string nothing = *get("api/light", {{"epoch", epoch}, {"since", version}}).body;
  EXPECT_TRUE(nothing.empty() || array_of<std::uint32_t>(nothing, "light").empty());
  EXPECT_EQ(*get("api/light", {{"epoch", epoch}, {"since", "-1x"}}).body, light)
      << "no number is none";

  const WebReply texels = get("api/texture", {{"id", "0"}});
  EXPECT_EQ(texels.type, "image/png");
  const auto picture = decode_image(
      {reinterpret_cast<const std::uint8_t*>(texels.body->data()), texels.body->size()}, "texture");
  ASSERT_TRUE(picture) << picture.error().line();
  EXPECT_EQ(picture->texels.front(), (std::array<std::uint8_t, 4>{10, 20, 30, 255}));
  const WebReply bytes = get("api/texture", {{"id", "1"}});
  EXPECT_EQ(bytes.type, "image/jpeg");
  EXPECT_EQ(*bytes.body, "\xff\xd8\xff");
  EXPECT_EQ(get("api/texture", {{"id", "2"}}).status, 404);
  EXPECT_EQ(get("api/texture").status, 404);
}

TEST_F(ViewRoutes, DrawWhatTheSolverWorksWith) {
  ASSERT_TRUE(live_.done());
  EXPECT_EQ(json_of(layer("elements"))["kind"], "elements");
  EXPECT_EQ(json_of(layer("clusters"))["depth"], 1);
  EXPECT_EQ(json_of(layer("clusters", R"(, "depth": 3)"))["depth"], 3);
  EXPECT_EQ(json_of(layer("error"))["kind"], "error");
  EXPECT_TRUE(json::parse(layer("histogram")).contains("counts"));
  const std::string classes = layer("features", std::string(R"(, "pixels": 4, "view": )") + kDown);
  EXPECT_FALSE(array_of<std::uint32_t>(classes, "classes").empty());
  const json seen =
      json::parse(*post("api/probe", R"({"origin": [1.4, 1, 1.4], "direction": [0, -1, 0]})").body);
  ASSERT_TRUE(seen["hit"].get<bool>());
  const std::string element = R"(, "element": )" + seen["element"]["id"].dump();
  EXPECT_EQ(json_of(layer("links", element))["kind"], "links");

  EXPECT_EQ(post("api/layer", R"({"kind": "cut")" + element + "}").status, 400)
      << "rays are exact here";
  for (const char* bad : {"", "[]", R"({"kind": "nothing"})", R"({"kind": "links"})",
                          R"({"kind": "features", "view": {"up": [0, 0, 1]}})", R"({"kind": 3})"})
    EXPECT_EQ(post("api/layer", bad).status, 400) << bad;
}

TEST_F(ViewRoutes, TakeCommandsAndProbesThatMakeSense) {
  ASSERT_TRUE(live_.done());
  EXPECT_EQ(post("api/control", R"({"paused": true})").status, 200);
  EXPECT_EQ(post("api/control", R"({"featureSize": -1})").status, 400);
  EXPECT_EQ(post("api/control", R"({"node": 1000, "shown": false})").status, 400);
  const json sky = json::parse(
      *post("api/probe", R"({"origin": [1, 9, 1], "direction": [0, 1, 0], "exact": true})").body);
  EXPECT_FALSE(sky["hit"].get<bool>());
  for (const char* bad :
       {"", "[]", R"({"origin": [1, 2, 3]})", R"({"origin": [1, 2, 3], "direction": [0, 0, 0]})",
        R"({"origin": [1, 2], "direction": [0, 1, 0]})",
        R"({"origin": [1, 2, "3"], "direction": [0, 1, 0]})"})
    EXPECT_EQ(post("api/probe", bad).status, 400) << bad;
}

TEST_F(ViewRoutes, GiveFilesToTakeHome) {
  ASSERT_TRUE(live_.done());
  const WebReply lit = post("api/lit.glb", "");
  EXPECT_EQ(lit.status, 200);
  EXPECT_EQ(lit.type, "model/gltf-binary");
  EXPECT_EQ(lit.download_name, "lit.glb");
  EXPECT_EQ(lit.body->substr(0, 4), "glTF");
  const WebReply picture = post("api/view.exr", kDown);
  EXPECT_EQ(picture.status, 200) << *picture.body;
  EXPECT_EQ(picture.type, "image/x-exr");
  EXPECT_EQ(picture.download_name, "view.exr");
  EXPECT_EQ(picture.body->substr(0, 4), "\x76\x2f\x31\x01");
  EXPECT_EQ(post("api/view.exr", R"({"up": [0, 0, 1]})").status, 400);
}

TEST(ViewRoutesEarly, SayThatTheSceneIsNotThereYet) {
  ViewSession broken([]() -> Result<Scene> { return input_error("bad", "room.glb", "mend it"); },
                     {});
  const auto handler = view_routes(broken, {});
  EXPECT_EQ(handler({false, "api/topology", {}, ""}).status, 503);
  EXPECT_EQ(handler({false, "api/texture", {{"id", "0"}}, ""}).status, 404);
  const WebReply lit = handler({true, "api/lit.glb", {}, ""});
  EXPECT_EQ(lit.status, 400);
  EXPECT_THAT(*lit.body, ::testing::HasSubstr("mend it"));
}

}  // namespace
}  // namespace halflight
