#include "renderer/session/sample_sequence.h"

#include <algorithm>

namespace meristem {

namespace {

std::size_t index_in(const PixelWindow& window, int x, int y) {
  return std::size_t(y - window.y0) * std::size_t(window.width()) + std::size_t(x - window.x0);
}

}  // namespace

SampleSequence::SampleSequence(const Film& film, const std::vector<PixelWindow>& tiles, std::uint32_t first_sample)
    : window_(film.window()), tiles_(tiles), first_sample_(first_sample) {
  std::erase_if(tiles_, [](const PixelWindow& tile) { return tile.empty(); });
  had_.reserve(std::size_t(window_.width()) * std::size_t(window_.height()));
  for (int y = window_.y0; y < window_.y1; ++y)
    for (int x = window_.x0; x < window_.x1; ++x) had_.push_back(film.samples(x, y));
  if (had_.empty()) return;
  const auto [least, most] = std::ranges::minmax_element(had_);
  round_ = *least, most_had_ = *most;
  begin_round();
}

void SampleSequence::extend(std::uint32_t end, const std::vector<std::uint8_t>& is_finished) {
  end_ = end;
  finished_ = is_finished;
}

void SampleSequence::begin_round() {
  if (round_ >= most_had_) had_ = {};
  begin_tile(0);
}

void SampleSequence::begin_tile(std::size_t tile) {
  tile_ = tile;
  if (tile < tiles_.size()) x_ = tiles_[tile].x0, y_ = tiles_[tile].y0;
}

bool SampleSequence::next(PixelSample& sample) {
  for (; round_ < end_; ++round_, begin_round())
    while (tile_ < tiles_.size()) {
      const PixelWindow& tile = tiles_[tile_];
      const int x = x_, y = y_;
      if (++x_ == tile.x1) x_ = tile.x0, ++y_;
      if (y_ == tile.y1) begin_tile(tile_ + 1);
      if (!is_due(index_in(window_, x, y))) continue;
      sample = {x, y, first_sample_ + round_};
      return true;
    }
  return false;
}

std::uint32_t SampleOrder::add(const PixelSample& at, const FilmSample& sample) {
  const std::size_t pixel = index_in(film_.window(), at.x, at.y);
  const auto is_next = [&](std::uint32_t number) { return number == first_sample_ + film_.samples(at.x, at.y); };
  if (!is_next(sample.number)) {
    keep(pixel, sample);
    return 0;
  }
  film_.add(at.x, at.y, sample);
  std::uint32_t added = 1;
  if (first_kept_.empty()) return added;
  // In the order of their numbers
  Index& first = first_kept_[pixel];
  while (first != none && is_next(kept_[first].number)) {
    film_.add(at.x, at.y, kept(first));
    ++added;
    const Index next = kept_[first].next;
    kept_[first].next = free_;
    free_ = first;
    first = next;
  }
  return added;
}

void SampleOrder::keep(std::size_t pixel, const FilmSample& sample) {
  if (free_ == none) {
    free_ = Index(kept_.grow());
    kept_[free_].next = none;
    if (film_.wants_first_surface()) surfaces_.grow();
    if (film_.wants_costs()) costs_.grow();
  }
  const Index i = free_;
  free_ = kept_[i].next;
  if (first_kept_.empty())
    first_kept_.resize(std::size_t(film_.window().width()) * std::size_t(film_.window().height()), none);
  Index* place = &first_kept_[pixel];
  while (*place != none && kept_[*place].number < sample.number) place = &kept_[*place].next;
  kept_[i] = {sample.radiance, sample.number, *place, std::int8_t(sample.weight), sample.covered};
  *place = i;
  if (!surfaces_.empty()) surfaces_[i] = {sample.first ? *sample.first : FirstSurface{}, sample.depth, sample.motion};
  if (!costs_.empty()) costs_[i] = {sample.nanoseconds, sample.expansions};
  count_bytes();
}

FilmSample SampleOrder::kept(Index i) const {
  const Kept& k = kept_[i];
  FilmSample sample{.radiance = k.radiance, .covered = k.covered, .weight = k.weight, .number = k.number};
  if (!surfaces_.empty()) {
    const Surface& s = surfaces_[i];
    sample.first = &s.first, sample.depth = s.depth, sample.motion = s.motion;
  }
  if (!costs_.empty()) sample.nanoseconds = costs_[i].nanoseconds, sample.expansions = costs_[i].expansions;
  return sample;
}

void SampleOrder::count_bytes() {
  bytes_.store(kept_.bytes() + surfaces_.bytes() + costs_.bytes() + first_kept_.capacity() * sizeof(Index),
               std::memory_order_relaxed);
}

}  // namespace meristem
