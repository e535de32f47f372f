#include "halflight/view/view_routes.h"

#include <algorithm>
#include <charconv>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "halflight/io/encode_png.h"
#include "halflight/view/packet.h"
#include "halflight/view/view_downloads.h"
#include "halflight/view/view_layers.h"
#include "halflight/view/view_queries.h"

namespace halflight {
namespace {

using nlohmann::json;

constexpr const char* kBinary = "application/octet-stream";
constexpr double kAnswerSeconds = 5.0, kLayerSeconds = 30.0;
constexpr double kEventSeconds = 1.0;
constexpr std::uint64_t kDeepest = 64;

WebReply error_reply(int status, const Error& error) {
  return web_text(status, "application/json",
                  json_text({{"error", error.what}, {"remedy", error.remedy}}));
}

WebReply error_reply(const Error& error) {
  return error_reply(error.kind == Error::Kind::input ? 400 : 503, error);
}

WebReply reply_of(Result<std::string> answer, const char* type) {
  if (!answer) return error_reply(answer.error());
  return web_text(200, type, std::move(*answer));
}

std::uint64_t number(const WebRequest& request, const char* name, std::uint64_t otherwise) {
  const auto at = request.query.find(name);
  if (at == request.query.end()) return otherwise;
  const std::string& text = at->second;
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : otherwise;
}

WebReply events(const ViewSession& session) {
  WebReply reply;
  reply.events = [&session, seen = std::uint64_t{0}]() mutable -> std::optional<std::string> {
    const auto status = session.wait_status(seen, kEventSeconds);
    return status ? fmt::format("data: {}\n\n", *status) : std::string();
  };
  return reply;
}

WebReply topology(const ViewSession& session) {
  WebReply reply;
  reply.type = kBinary;
  reply.body = session.topology();
  if (!reply.body) return error_reply(503, {"the scene is not there yet", "", "wait a moment", {}});
  return reply;
}

WebReply texture(const ViewSession& session, const WebRequest& request) {
  const auto world = session.world();
  const TextureId id(static_cast<std::size_t>(number(request, "id", TextureId::kInvalid)));
  if (!world || !world->scene.textures.contains(id))
    return error_reply(404, {"there is no such texture", "", "reload the page", {}});
  const Texture& t = world->scene.textures[id];
  if (t.mime_type == "image/png" || t.mime_type == "image/jpeg")
    return web_text(200, t.mime_type, std::string(t.encoded.begin(), t.encoded.end()));
  const std::vector<std::uint8_t> png = encode_png(t.width, t.height, t.texels);
  return web_text(200, "image/png", std::string(png.begin(), png.end()));
}

WebReply control(ViewSession& session, const WebRequest& request) {
  auto command = parse_view_command(request.body);
  if (!command) return error_reply(command.error());
  if (auto ok = session.command(std::move(*command)); !ok) return error_reply(ok.error());
  return web_text(200, "application/json", "{}");
}

WebReply layer(ViewSession& session, const WebRequest& request) {
  const json asked = parsed_request(request.body);
  const auto member = [&](const char* name) {
    return asked.is_object() && asked.contains(name) ? asked[name] : json();
  };
  const json kind = member("kind");
  const json element = member("element"), depth = member("depth"), pixels = member("pixels");
  const ElementId id(element.is_number_unsigned() ? element.get<std::size_t>()
                                                  : std::size_t{ElementId::kInvalid});
  ViewSession::Question question;
  const char* type = kBinary;
  if (kind == "elements") question = [](LiveSolution& live) { return elements_packet(live); };
  if (kind == "clusters") {
    const std::uint64_t wanted = depth.is_number_unsigned() ? depth.get<std::uint64_t>() : 1;
    const int at = static_cast<int>(std::min<std::uint64_t>(wanted, kDeepest));
    question = [at](LiveSolution& live) { return clusters_packet(live, at); };
  }
  if (kind == "links") question = [id](LiveSolution& live) { return links_packet(live, id); };
  if (kind == "cut") question = [id](LiveSolution& live) { return cut_packet(live, id); };
  if (kind == "error") question = [](LiveSolution& live) { return error_packet(live); };
  if (kind == "histogram") {
    question = [](LiveSolution& live) { return histogram(live); };
    type = "application/json";
  }
  if (kind == "features") {
    const auto view = parse_view_of_interest(json_text(member("view")));
    if (!view) return error_reply(view.error());
    const float width = pixels.is_number() ? std::clamp(pixels.get<float>(), 1.f, 4096.f) : 8.f;
    question = [view = *view, width](LiveSolution& live) {
      return feature_mask_packet(live, view, width);
    };
  }
  if (!question) return error_reply(400, {"there is no such layer", "", "reload the page", {}});
  return reply_of(session.ask(std::move(question), kLayerSeconds), type);
}

// A solver that is busy has no answer to a pointer that passes by; that is no error.
WebReply probe_reply(ViewSession& session, const WebRequest& request) {
  const auto ray = parse_probe_ray(request.body);
  if (!ray) return error_reply(ray.error());
  const auto answer = session.ask(
      [ray = *ray](LiveSolution& live) -> Result<std::string> { return probe(live, ray); },
      kAnswerSeconds);
  if (!answer && answer.error().kind == Error::Kind::system)
    return web_text(200, "application/json", json_text({{"hit", false}, {"busy", true}}));
  return reply_of(answer, "application/json");
}

WebReply lit_scene(ViewSession& session) {
  WebReply reply = reply_of(session.ask_copy(lit_glb, kLayerSeconds), "model/gltf-binary");
  if (reply.status == 200) reply.download_name = "lit.glb";
  return reply;
}

WebReply picture(ViewSession& session, const WebRequest& request) {
  const auto view = parse_view_of_interest(request.body);
  if (!view) return error_reply(view.error());
  WebReply reply = reply_of(session.ask_copy(
                                [&view](const SolutionCopy& solution, const Progress& progress) {
                                  return hdr_picture(solution, *view, progress);
                                },
                                kLayerSeconds),
                            "image/x-exr");
  if (reply.status == 200) reply.download_name = "view.exr";
  return reply;
}

}  // namespace

LoopbackServer::Handler view_routes(ViewSession& session, const PageFiles& page) {
  using Route = std::function<WebReply(const WebRequest&)>;
  std::map<std::pair<bool, std::string>, Route> routes;
  for (const auto& [path, file] : page)
    routes[{false, path}] = [file = file](const WebRequest&) {
      return web_text(200, file.type, std::string(file.bytes));
    };
  const auto get = [&](const char* path, Route route) { routes[{false, path}] = std::move(route); };
  const auto post = [&](const char* path, Route route) { routes[{true, path}] = std::move(route); };
  ViewSession* s = &session;
  get("api/status",
      [s](const WebRequest&) { return web_text(200, "application/json", s->status()); });
  get("api/events", [s](const WebRequest&) { return events(*s); });
  get("api/topology", [s](const WebRequest&) { return topology(*s); });
  get("api/light", [s](const WebRequest& r) {
    const auto epoch = static_cast<std::uint32_t>(number(r, "epoch", 0));
    return web_text(200, kBinary, s->frames().since(epoch, number(r, "since", 0)));
  });
  get("api/history", [s](const WebRequest& r) {
    return web_text(200, "application/json", s->history(number(r, "since", 0)));
  });
  get("api/texture", [s](const WebRequest& r) { return texture(*s, r); });
  post("api/control", [s](const WebRequest& r) { return control(*s, r); });
  post("api/probe", [s](const WebRequest& r) { return probe_reply(*s, r); });
  post("api/layer", [s](const WebRequest& r) { return layer(*s, r); });
  post("api/lit.glb", [s](const WebRequest&) { return lit_scene(*s); });
  post("api/view.exr", [s](const WebRequest& r) { return picture(*s, r); });
  return [routes = std::move(routes)](const WebRequest& request) {
    const auto route = routes.find({request.post, request.path});
    if (route != routes.end()) return route->second(request);
    return error_reply(404, {"there is nothing at this address", "", "reload the page", {}});
  };
}

}  // namespace halflight
