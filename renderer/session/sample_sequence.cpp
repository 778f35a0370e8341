#include "renderer/session/sample_sequence.h"

#include <algorithm>

namespace meristem {

SampleSequence::SampleSequence(const Film& film, const std::vector<PixelWindow>& tiles, std::uint32_t first_sample)
    : window_(film.window()), first_sample_(first_sample) {
  const auto width = std::uint32_t(window_.width());
  for (const PixelWindow& tile : tiles)
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x)
        pixels_.push_back(std::uint32_t(y - window_.y0) * width + std::uint32_t(x - window_.x0));
  taken_.reserve(pixels_.size());
  for (int y = window_.y0; y < window_.y1; ++y)
    for (int x = window_.x0; x < window_.x1; ++x) taken_.push_back(film.samples(x, y));
  if (!taken_.empty()) round_ = *std::ranges::min_element(taken_);
}

void SampleSequence::extend(std::uint32_t end, const std::vector<std::uint8_t>& is_finished) {
  end_ = end;
  finished_ = is_finished;
}

bool SampleSequence::next(PixelSample& sample) {
  for (; round_ < end_; ++round_, position_ = 0)
    while (position_ < pixels_.size()) {
      const std::uint32_t pixel = pixels_[position_++];
      if (taken_[pixel] != round_ || (!finished_.empty() && finished_[pixel])) continue;
      ++taken_[pixel];
      const auto width = std::uint32_t(window_.width());
      sample = {window_.x0 + int(pixel % width), window_.y0 + int(pixel / width), first_sample_ + round_};
      return true;
    }
  return false;
}

std::uint32_t SampleOrder::add(const PixelSample& at, const FilmSample& sample) {
  const std::uint64_t pixel = std::uint64_t(at.y) << 32 | std::uint32_t(at.x);
  const auto is_next = [&](std::uint32_t number) { return number == first_sample_ + film_.samples(at.x, at.y); };
  if (!is_next(sample.number)) {
    Kept& kept = kept_[pixel].emplace_back(sample, FirstSurface{});
    if (sample.first) kept.first = *sample.first;
    return 0;
  }
  film_.add(at.x, at.y, sample);
  std::uint32_t added = 1;
  const auto waiting = kept_.find(pixel);
  if (waiting == kept_.end()) return added;
  std::vector<Kept>& others = waiting->second;
  for (auto it = others.begin(); it != others.end();) {
    if (!is_next(it->sample.number)) {
      ++it;
      continue;
    }
    if (it->sample.first) it->sample.first = &it->first;
    film_.add(at.x, at.y, it->sample);
    ++added;
    others.erase(it);
    it = others.begin();
  }
  if (others.empty()) kept_.erase(waiting);
  return added;
}

}  // namespace meristem
