// The manual: pages of text and Markdown about components, generated from the parameters they declare.
#pragma once

#include "renderer/language/catalogue.h"

#include <string>
#include <vector>

namespace meristem {

// For a terminal of 100 columns. `name` is that of a component ("sky"; "light.sky" where two kinds share a name), of a
// kind ("light": the pages of all its components), or empty: the list of all components. An empty text if there is
// nothing of that name.
std::string describe(const Catalogue& catalogue, const std::string& name);

// Every name that describe() knows: kinds and components, sorted.
std::vector<std::string> described_names(const Catalogue& catalogue);

// One document with a chapter for each kind and a table of parameters for each component.
std::string markdown(const Catalogue& catalogue);

}  // namespace meristem
