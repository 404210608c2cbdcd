#include "common/contact/narrow_phase.h"

#include <algorithm>

#include "common/contact/simplex_distance.h"

namespace palpate {
namespace {

/// The contact of one triangle: nodes of its closest feature in ascending order, so that neighbours agree.
Contact contact_on(const std::array<int, 3>& triangle, const ClosestPoint& closest) noexcept {
  Contact contact{{-1, -1, -1}, {0, 0, 0}, 0, Vec3::Zero(), 0};
  std::array<int, 3> corner{0, 1, 2};
  std::sort(corner.begin(), corner.end(), [&](int a, int b) { return triangle[a] < triangle[b]; });
  for (const int c : corner) {
    if (closest.feature_size < 3 && closest.weight[c] == 0) continue;
    contact.node[contact.size] = triangle[c];
    contact.weight[contact.size++] = closest.weight[c];
  }
  return contact;
}

}  // namespace

void find_contacts_on_patch(std::span<const Vec3> x, std::span<const std::array<int, 3>> triangles,
                            const Vec3& p, double reach, std::vector<Contact>& contacts) noexcept {
  contacts.clear();
  for (const auto& triangle : triangles) {
    const Vec3 &a = x[triangle[0]], &b = x[triangle[1]], &c = x[triangle[2]];
    const ClosestPoint closest = closest_point(p, a, b, c);
    const Vec3 to_tool = p - (closest.weight[0] * a + closest.weight[1] * b + closest.weight[2] * c);
    const double distance = to_tool.norm();
    if (distance > reach) continue;
    Contact contact = contact_on(triangle, closest);
    const auto same = [&](const Contact& other) { return other.node == contact.node; };
    if (std::any_of(contacts.begin(), contacts.end(), same)) continue;
    contact.distance = distance;
    // A centre exactly on the surface has no direction of its own: take the face's.
    contact.normal = distance > 0 ? Vec3(to_tool / distance) : (b - a).cross(c - a).normalized();
    contacts.push_back(contact);
  }
}

}  // namespace palpate
