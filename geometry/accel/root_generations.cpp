#include "geometry/accel/root_generations.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

namespace meristem {

namespace {

class Finder {
 public:
  std::size_t find(const ModelRoot* root) {
    if (const auto known = found_.find(root); known != found_.end()) return known->second;
    std::vector<const ModelRoot*> placed;
    root->add_placed(placed);
    std::size_t generation = 0;
    for (const ModelRoot* p : placed) generation = std::max(generation, find(p) + 1);
    found_.emplace(root, generation);
    generations_.resize(std::max(generations_.size(), generation + 1));
    generations_[generation].push_back(root);
    return generation;
  }
  std::vector<std::vector<const ModelRoot*>> take() { return std::move(generations_); }

 private:
  std::unordered_map<const ModelRoot*, std::size_t> found_;
  std::vector<std::vector<const ModelRoot*>> generations_;
};

}  // namespace

std::vector<std::vector<const ModelRoot*>> root_generations(const std::vector<const ModelRoot*>& roots) {
  Finder finder;
  for (const ModelRoot* root : roots) finder.find(root);
  return finder.take();
}

}  // namespace meristem
