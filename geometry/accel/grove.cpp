#include "geometry/accel/grove.h"

#include "geometry/accel/few_boxes.h"

#include <algorithm>

namespace meristem {

namespace {

// Faces that come of one quad follow each other: a group is what came of one two levels before.
constexpr std::uint32_t fewest_faces = 4;
constexpr std::uint32_t most_groups = FewBoxes::most;

}  // namespace

bool Grove::is_worthwhile(const Furnishing& furnishing) {
  constexpr std::uint32_t many = 32;
  std::uint32_t standing = 0;
  for (std::uint32_t f = 0; f < furnishing.face_count() && standing < many; ++f) standing += furnishing.most_on(f);
  return standing >= many && furnishing.face_count() > fewest_faces;
}

Grove::Grove(std::unique_ptr<const Furnishing> furnishing, const PlacedReach& reach)
    : furnishing_(std::move(furnishing)),
      faces_of_group_(std::max(fewest_faces, (furnishing_->face_count() + most_groups - 1) / most_groups)) {
  const std::uint32_t faces = furnishing_->face_count();
  for (std::uint32_t begin = 0; begin < faces; begin += faces_of_group_) {
    const std::uint32_t end = std::min(begin + faces_of_group_, faces);
    std::uint32_t standing = 0;
    for (std::uint32_t f = begin; f < end; ++f) standing += furnishing_->most_on(f);
    bounds_.push_back(furnishing_->bounds(begin, end, reach));
    first_numbers_.push_back(first_numbers_.back() + standing);
  }
}

std::vector<Placement> Grove::placements(std::size_t group) const {
  std::vector<Placement> placements;
  placements.reserve(most_in(group));
  const auto begin = std::uint32_t(group) * faces_of_group_;
  furnishing_->place(begin, std::min(begin + faces_of_group_, furnishing_->face_count()), placements);
  return placements;
}

std::size_t Grove::bytes() const {
  return furnishing_->bytes() + first_numbers_.capacity() * 4 + bounds_.capacity() * sizeof(Bounds3f);
}

}  // namespace meristem
