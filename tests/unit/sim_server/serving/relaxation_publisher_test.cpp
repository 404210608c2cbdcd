// What relaxes is told in parts: none makes a datagram too long, and after some samples all has been told.
#include "sim_server/serving/relaxation_publisher.h"

#include <numeric>
#include <set>

#include "protocol/codec.h"
#include "tests/support/allocation_guard.h"
#include "tests/support/catch.h"

using namespace palpate;
using namespace palpate::sim;
using protocol::ForceSample;

namespace {

constexpr int kVertices = 40;

PublishedModes modes_of(int count, int terms) {
  VibrationModes found{Eigen::VectorXd::LinSpaced(count, 10, 400),
                       Eigen::MatrixXd::Ones(3 * kVertices, count)};
  std::vector<int> first(kVertices);
  for (int v = 0; v < kVertices; ++v) first[static_cast<std::size_t>(v)] = 3 * v;
  PublishedModes modes(found, first, {});
  modes.relaxations.assign(static_cast<std::size_t>(terms), {0.2, 0.5});
  return modes;
}

/// All that a sample can have beside, of as many modes.
ForceSample longest_sample(int modes) {
  ForceSample sample{.number = 1};
  sample.flags = ForceSample::kHasTangent | ForceSample::kHasAhead | ForceSample::kHasSurface |
                 ForceSample::kHasErrors | ForceSample::kHasModes | ForceSample::kHasMean;
  sample.surface.tool_radius = 0.005;
  sample.modes.count = static_cast<std::uint8_t>(modes);
  return sample;
}

}  // namespace

TEST_CASE(
    "relaxation publisher: in whatever many terms, all modes and vertices of note are told, a part each "
    "time") {
  for (const int count : {1, 40, kMaxPublishedModes}) {
    for (const int terms : {1, 2, kMostRelaxations}) {
      CAPTURE(count, terms);
      const PublishedModes modes = modes_of(count, terms);
      REQUIRE(modes.published == count);
      std::vector<int> vertices(kVertices);
      std::iota(vertices.rbegin(), vertices.rend(), 0);  // vertex i of the model is one of the surface
      RelaxationPublisher publisher(modes, vertices);
      ModalMotion state;
      state.z = Eigen::MatrixXd::Random(count, terms);
      state.psi.assign(static_cast<std::size_t>(kVertices * terms), Vec3::Zero());
      std::set<int> of_note;
      for (int v = 0; v < kVertices; v += 3) {
        state.psi[static_cast<std::size_t>(v * terms + terms - 1)] = Vec3(0, -1 - v, 2);
        of_note.insert(kVertices - 1 - v);
      }
      std::set<int> published_modes, published_vertices;
      const auto wanted = static_cast<std::size_t>(count);
      int samples = 0;
      for (; published_modes.size() < wanted || published_vertices.size() < of_note.size(); ++samples) {
        REQUIRE(samples < 40);
        ForceSample sample = longest_sample(count);
        const test::AllocationGuard guard;
        publisher.report(state, sample);
        REQUIRE(guard.count() == 0);
        std::array<std::byte, 2 * protocol::kMaxDatagram> bytes;
        const std::size_t size = protocol::encode({1, 1}, sample, bytes);
        REQUIRE(size + protocol::kTagBytes <= protocol::kMaxDatagram);
        protocol::Datagram datagram;
        REQUIRE(protocol::decode(std::span(bytes).first(size), datagram) == protocol::Verdict::kAccepted);
        const protocol::RelaxedState& published = std::get<ForceSample>(datagram.message).relaxed;
        for (int k = 0; k < published.count; ++k) {
          published_modes.insert(published.first + k);
          CHECK(published.z[static_cast<std::size_t>(k * terms)] ==
                static_cast<float>(state.z(published.first + k, 0)));
        }
        for (std::size_t i = 0; i < published.vertices; ++i) {
          const int number = published.vertex[i].number;
          published_vertices.insert(number);
          CHECK(published.vertex[i].psi[static_cast<std::size_t>(3 * terms - 2)] ==
                static_cast<float>(-1 - (kVertices - 1 - number)));
        }
      }
      CHECK(published_vertices == of_note);
      if (count == 40 && terms == 1) CHECK(samples == 1);
    }
  }
}
