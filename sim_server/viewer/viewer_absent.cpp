/// Stands in for viewer.cpp in a build without libwebsockets (PALPATE_VIEWER=OFF): nothing can be made, so
/// nothing is ever called.
#include "common/error.h"
#include "sim_server/viewer/viewer.h"

namespace palpate::sim {

void require_free(const ViewerAddress&) {
  fail(
      "--viewer: the live page was left out of this build (PALPATE_VIEWER=OFF); build with it, and "
      "libwebsockets-dev, or run without --viewer");
}

struct Viewer::Server {
  protocol::Endpoint endpoint;
};
// NOLINTNEXTLINE(performance-unnecessary-value-param): of the signature of the other one
Viewer::Viewer(const ViewerAddress& address, std::string, const SceneFacts&, ViewerFeed&, const Bytes*) {
  require_free(address);
}
Viewer::~Viewer() = default;
const protocol::Endpoint& Viewer::endpoint() const {
  return server_->endpoint;
}
void Viewer::run() noexcept {}
void Viewer::stop() noexcept {}
void Viewer::ring() noexcept {}

}  // namespace palpate::sim
