// The words of a pbrt scene file, included files in their places: names, texts in quotes, numbers and brackets, each
// with where it stands. For files of strangers: limits on sizes, on the depth of includes and against cycles.
#pragma once

#include "geometry/base/source.h"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace meristem {

struct PbrtToken {
  enum class Kind { End, Word, Text, Open, Close };  // numbers, true and false are words
  Kind kind = Kind::End;
  std::string_view text;  // a Text without its quotes
  Location where;
};

class PbrtTokens {
 public:
  // The file at `path`; its folder is that of all names in it.
  PbrtTokens(const std::string& path, Diagnostics& diagnostics);

  PbrtToken next();
  const PbrtToken& peek();
  // Goes on with that file, then here. `where`: of the statement.
  void include(const std::string& file, const Location& where);
  const std::string& folder() const { return folder_; }

 private:
  struct Open {
    std::shared_ptr<const SourceText> source;
    std::string path;
    std::size_t at = 0;
  };
  void open(const std::string& path, const std::string& name, const Location& where);
  PbrtToken read();
  void skip_blanks(Open& file) const;

  Diagnostics& diagnostics_;
  std::string folder_;
  std::vector<Open> open_;
  std::size_t bytes_ = 0;  // of all files so far
  PbrtToken peeked_;
  bool has_peeked_ = false;
};

}  // namespace meristem
