// What each address of the live view answers.
#pragma once

#include <map>
#include <string>
#include <string_view>

#include "halflight/view/loopback_server.h"
#include "halflight/view/view_session.h"

namespace halflight {

struct PageFile {
  std::string type;
  std::string_view bytes;
};
using PageFiles = std::map<std::string, PageFile, std::less<>>;  // by path; "" is the page itself

// The session must outlive the server that gets this handler.
LoopbackServer::Handler view_routes(ViewSession& session, const PageFiles& page);

}  // namespace halflight
